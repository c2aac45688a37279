#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace iwalk {

std::string hostName();

// MPI comes up when all ranks have started. Until this is destroyed, and at most for so many seconds; then it
// says who is here and ends the process.
class StartWatch {
  public:
    explicit StartWatch(int seconds) : seconds_(seconds), thread_([this] { watch(); }) {}
    ~StartWatch();

  private:
    void watch();

    const int seconds_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool up_ = false;  // guarded by mutex_
    std::thread thread_;
};

}  // namespace iwalk
