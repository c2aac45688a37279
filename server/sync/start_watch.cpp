#include "server/sync/start_watch.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace iwalk {

std::string hostName() {
    char name[256] = "";
    gethostname(name, sizeof name - 1);
    return name;
}

StartWatch::~StartWatch() {
    {
        const std::lock_guard lock(mutex_);
        up_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void StartWatch::watch() {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, std::chrono::seconds(seconds_), [this] { return up_; })) return;
    const char* rank = std::getenv("OMPI_COMM_WORLD_RANK");
    const char* size = std::getenv("OMPI_COMM_WORLD_SIZE");
    std::fprintf(
        stderr,
        "iwalk-server: rank %s of %s on %s is here, but not all others have started within %d s: who "
        "does not say this is missing\n",
        rank ? rank : "?", size ? size : "?", hostName().c_str(), seconds_);
    std::_Exit(EXIT_FAILURE);
}

}  // namespace iwalk
