#include "app/batch/batch_result.h"

#include <algorithm>

namespace app {

int status_of(const BatchResult& batch) {
    int status = batch.unchecked.empty() ? 0 : 2;
    for (const ProgramResult& program : batch.programs)
        status = std::max(status, status_of(program));
    return status;
}

size_t count_of(const ProgramResult& result, core::Severity severity) {
    return static_cast<size_t>(
        std::count_if(result.findings.begin(), result.findings.end(),
                      [&](const KeptFinding& finding) { return finding.severity == severity; }));
}

} // namespace app
