#pragma once

#include <string>

#include "app/view/model/job_file.h"

namespace app {

struct CheckJob;

/// What a file of a CAM system or of the control says about a job: the set-up with the tools and
/// the stock of a FreeCAD job (.FCStd), which replaces nothing that is stated; or how the offsets
/// in a file from the control differ from those of the set-up; or why the file cannot be used.
/// Changes no file.
viewer::JobFileNews read_job_file(const CheckJob& job, const std::string& path);

} // namespace app
