#pragma once

#include <functional>

namespace iwalk {

// A driver that can make windows swap in the same refresh of their screens (NV_swap_group).
class SwapGroupDriver {
  public:
    virtual ~SwapGroupDriver() = default;
    virtual bool join() = 0;  // false: there is no such driver
    virtual void leave() = 0;
};

// A wall's windows meet at the software barrier before they swap, which puts them within a refresh of one
// another; a swap group puts them into the same. Half a group would wait for ever, so all windows join or
// none.
class SwapGroup {
  public:
    // `agree`: true on all ranks when it is called with true on all (Sync::agree). `driver` is kept by
    // reference; null: this rank has none.
    SwapGroup(SwapGroupDriver* driver, const std::function<bool(bool)>& agree) : driver_(driver) {
        const bool mine = driver_ && driver_->join();
        joined_ = agree(mine);
        if (mine && !joined_) driver_->leave();
    }
    ~SwapGroup() {
        if (joined_) driver_->leave();
    }
    SwapGroup(const SwapGroup&) = delete;
    SwapGroup& operator=(const SwapGroup&) = delete;

    bool joined() const { return joined_; }

  private:
    SwapGroupDriver* const driver_;
    bool joined_ = false;
};

}  // namespace iwalk
