// Exists so that headers.h has a target that precompiles it.
#include "cmake/headers.h"
