#pragma once

#include <string>

#include "app/library/result/batch_result.h"

namespace app {

/// A batch as JUnit has it, in XML: a test case for each program, with its errors as a failure; one
/// that could not be run to its end has an error, one that was not checked was skipped. Warnings
/// and notes stand in the case's output.
std::string junit_report(const BatchResult& batch);

} // namespace app
