#pragma once

#include <string>
#include <vector>

#include "app/batch/program_result.h"

namespace app {

/// Whether any text of a result may name a file or a folder of its check by its path, beside the
/// program and the set-up: as the job names them, as the check asked for them, or any in `folder`.
/// Rather yes than no: such a text is right only where the same paths are given.
bool quotes_paths(const ProgramResult& result, const CheckJob& job,
                  const std::vector<InputFile>& inputs, const std::string& folder);

/// The same result for the same job under other names of program and set-up.
ProgramResult renamed(ProgramResult result, const CheckJob& job);

} // namespace app
