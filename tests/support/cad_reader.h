#pragma once

#include "core/cad/cad_file.h"

namespace test_support {

/// Uses the program of this build that reads CAD files; false if it was built without one.
inline bool use_cad_reader() {
#ifdef FEELER_CAD_READER
    core::set_cad_reader(FEELER_CAD_READER);
    return true;
#else
    return false;
#endif
}

} // namespace test_support
