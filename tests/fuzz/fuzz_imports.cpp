#include <cstddef>
#include <cstdint>

#include "tests/fuzz/import_runs.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    test_support::run_any_import({data, size});
    return 0;
}
