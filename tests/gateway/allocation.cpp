#include "tests/gateway/allocation.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

thread_local std::size_t largest = 0;

}  // namespace

namespace iwalk::testing {

std::size_t largestAllocation() {
    return largest;
}
void resetLargestAllocation() {
    largest = 0;
}

}  // namespace iwalk::testing

void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    largest = std::max(largest, bytes);
    return std::malloc(bytes);
}
void* operator new(std::size_t bytes) {
    void* place = operator new(bytes, std::nothrow);
    if (!place) throw std::bad_alloc();
    return place;
}
void operator delete(void* place) noexcept {
    std::free(place);
}
void operator delete(void* place, std::size_t) noexcept {
    std::free(place);
}
