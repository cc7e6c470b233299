#include <cstdint>

// Highway measures the resolution of a timer before main(), by an instruction that valgrind does
// not know. Its result is used by Highway's own benchmarks only.
namespace hwy::platform {
uint64_t TimerResolution();
uint64_t TimerResolution() { return 1; }
} // namespace hwy::platform
