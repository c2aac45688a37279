#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace iwalk {

// A few threads for work that falls into pieces (docs/threading.md). Whoever calls run() works, too: for one
// thread none is started.
class Workers {
  public:
    // What is shared takes some milliseconds only.
    static constexpr unsigned kMost = 4;

    // `threads`: with the caller's.
    explicit Workers(unsigned threads);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Calls work(0) to work(pieces - 1), each once, on any of the threads and in any order; returns when all
    // of them have returned. One call at a time.
    void run(std::size_t pieces, const std::function<void(std::size_t)>& work);

    // work(first, end) for parts of [0, count), each of `together` or what is left.
    void runParts(std::size_t count, std::size_t together,
                  const std::function<void(std::size_t first, std::size_t end)>& work);

  private:
    void loop();
    void takePieces(std::unique_lock<std::mutex>& lock);

    std::mutex mutex_;  // guards all below
    std::condition_variable begun_, done_;
    const std::function<void(std::size_t)>* work_ = nullptr;
    std::size_t pieces_ = 0, next_ = 0, finished_ = 0;  // of work_
    bool stop_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace iwalk
