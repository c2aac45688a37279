#pragma once

#include <cstdint>
#include <string>

namespace iwalk {

// Long work tells how far it is; rates and ETA are the listener's business.
class Progress {
  public:
    virtual ~Progress() = default;
    virtual void phase(const std::string& name) = 0;
    virtual void done(double part) = 0;       // 0..1 of the phase
    virtual void triangles(std::uint64_t) {}  // that each of the phases to come goes over
    virtual void note(const std::string&) {}  // what a person should know, in one line
};

}  // namespace iwalk
