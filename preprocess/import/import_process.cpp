#include "preprocess/import/import_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "common/settings.hpp"

extern char** environ;

namespace iwalk {
namespace {

constexpr std::size_t kMaxWords = 4096;  // of its last words, bytes

class Spawn {
  public:
    Spawn() { posix_spawn_file_actions_init(&actions_); }
    ~Spawn() { posix_spawn_file_actions_destroy(&actions_); }
    Spawn(const Spawn&) = delete;
    Spawn& operator=(const Spawn&) = delete;

    void descriptor(int from, int to) { posix_spawn_file_actions_adddup2(&actions_, from, to); }
    void open(int to, const char* path) {
        posix_spawn_file_actions_addopen(&actions_, to, path, O_RDONLY, 0);
    }
    // The process, or -errno.
    pid_t start(const std::vector<std::string>& words) {
        std::vector<char*> arguments;
        for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
        arguments.push_back(nullptr);
        pid_t process = 0;
        const int error = posix_spawn(&process, arguments[0], &actions_, nullptr, arguments.data(), environ);
        return error == 0 ? process : -error;
    }

  private:
    posix_spawn_file_actions_t actions_;
};

// How it ended; kills it when its time is over.
int waitFor(pid_t process, unsigned seconds, bool& late) {
    const int handle = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));
    if (handle >= 0) {
        pollfd ended{handle, POLLIN, 0};
        int ready = 0;
        do {
            ready = ::poll(&ended, 1, static_cast<int>(seconds * 1000));
        } while (ready < 0 && errno == EINTR);
        late = ready == 0;
        ::close(handle);
    }
    if (late) ::kill(process, SIGKILL);
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
}

// The last line of its own on standard error, without its name.
std::string lastWords(const SpillFile& file) {
    std::array<char, kMaxWords> text{};
    const ssize_t size = ::pread(file.descriptor(), text.data(), text.size(), 0);
    std::string_view rest(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    static constexpr std::string_view kName = "iwalk-import: ";
    const std::size_t begin = rest.rfind(kName);
    if (begin == rest.npos || (begin > 0 && rest[begin - 1] != '\n')) return "";
    rest.remove_prefix(begin + kName.size());
    return std::string(rest.substr(0, rest.find('\n')));
}

Error describe(const std::string& path, int status, bool late, const ImportProcessLimits& limits,
               const SpillFile& words) {
    if (late) return fail("{}: took longer than {} s to read: given up", path, limits.seconds);
    if (WIFEXITED(status)) {
        const std::string said = lastWords(words);
        if (!said.empty()) return fail("{}: {}", path, said);
        return fail("{}: cannot be read: iwalk-import ended with exit code {}", path, WEXITSTATUS(status));
    }
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) {
        return fail("{}: took more than {} s of a processor to read: given up", path, limits.cpuSeconds);
    }
    return fail("{}: the library that reads it crashed ({}), within {} of memory", path, strsignal(signal),
                formatBytes(limits.memoryBytes));
}

}  // namespace

Result<void> runImportProcess(const std::string& path, bool heights, const ImportProcessLimits& limits,
                              const SpillFile& output, const std::string& spillDirectory) {
    ASSIGN_OR_RETURN(const auto words, SpillFile::create(spillDirectory));
    std::error_code error;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::string program = self.parent_path() / "iwalk-import";
    Spawn spawn;
    spawn.open(STDIN_FILENO, "/dev/null");
    spawn.descriptor(output.descriptor(), STDOUT_FILENO);
    spawn.descriptor(words->descriptor(), STDERR_FILENO);
    std::vector<std::string> arguments{program,
                                       "--memory",
                                       fmt::format("{}", limits.memoryBytes),
                                       "--file",
                                       fmt::format("{}", limits.fileBytes),
                                       "--seconds",
                                       fmt::format("{}", limits.cpuSeconds)};
    if (heights) arguments.emplace_back("--heights");
    arguments.emplace_back("--");
    arguments.push_back(path);
    const pid_t process = spawn.start(arguments);
    if (process < 0) return fail("{}: cannot be started: {}", program, std::strerror(-process));
    bool late = false;
    const int status = waitFor(process, limits.seconds, late);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && !late) return {};
    return describe(path, status, late, limits, *words);
}

}  // namespace iwalk
