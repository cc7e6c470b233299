// Exists so that test_headers.h has a target that precompiles it.
#include "cmake/test_headers.h"
