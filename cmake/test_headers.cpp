// Source of the target that precompiles test_headers.h.
#include "cmake/test_headers.h"
