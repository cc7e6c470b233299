#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "app/commands/check_options.h"
#include "app/report/batch_text.h"

namespace app {

/// Where lines for a person go: to standard output, unless a report for others does.
struct BatchTalk {
    std::FILE* stream = stdout;
    BatchStyle style;

    void say(const std::string& text) const;
};

/// Coloured on a terminal, unless NO_COLOR is set.
BatchTalk talk_of(const BatchStyle& asked, const std::vector<ReportTarget>& targets);

} // namespace app
