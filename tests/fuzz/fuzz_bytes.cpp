#include <cstddef>
#include <cstdint>

#include "tests/fuzz/program_runs.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    test_support::run_any_bytes({data, size});
    return 0;
}
