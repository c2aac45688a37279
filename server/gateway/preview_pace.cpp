#include "server/gateway/preview_pace.hpp"

#include <algorithm>

#include "common/check.hpp"

namespace iwalk {

void PreviewPace::begin(Time now, std::size_t tiles) {
    CHECK_OP(awaited_, ==, 0u);
    stale_ = false;
    awaited_ = tiles;
    bytes_ = 0;
    begun_ = now;
}

void PreviewPace::arrived(std::size_t bytes, double fps, std::uint64_t bytesPerSecond) {
    CHECK_OP(awaited_, >, 0u);
    --awaited_;
    bytes_ += bytes;
    if (awaited_ > 0) return;
    const double seconds =
        std::max(1 / std::max(fps, 1e-3), static_cast<double>(bytes_) / static_cast<double>(bytesPerSecond));
    next_ = begun_ + std::chrono::ceil<Time::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace iwalk
