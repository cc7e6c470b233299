// Source of the target that precompiles headers.h.
#include "cmake/headers.h"
