#include "app/commands/check_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/check/check_run.h"
#include "app/commands/output.h"
#include "app/commands/suggestion.h"
#include "app/setup/setup_file.h"

namespace app {
namespace {

tl::unexpected<core::Error> refused(const std::string& why) {
    return core::fail(core::ErrorCode::invalid_value, why);
}

} // namespace

core::Result<std::vector<ReportTarget>> targets_of(const std::vector<std::string>& formats,
                                                   const std::vector<std::string>& outputs) {
    std::vector<ReportTarget> targets;
    for (const std::string& format : formats) targets.push_back({format, {}});
    if (targets.empty()) targets.push_back({"text", {}});
    if (outputs.size() > targets.size())
        return refused("more -o than --format: give the format of each file");
    if (targets.size() > outputs.size() + 1)
        return refused(
            "only one report can go to standard output: give an -o for each of the others, in "
            "the order of --format");
    for (size_t i = 0; i < outputs.size(); ++i) {
        targets[i].path = outputs[i];
        for (size_t k = 0; k < i; ++k)
            if (const auto target_path = resolved_path(targets[i].path);
                !target_path.empty() && target_path == resolved_path(targets[k].path))
                return refused(fmt::format("two reports would go to {}", targets[i].path));
    }
    return targets;
}

std::vector<std::string> paths_of(const std::vector<ReportTarget>& targets) {
    std::vector<std::string> paths;
    for (const ReportTarget& target : targets)
        if (!target.path.empty()) paths.push_back(target.path);
    return paths;
}

void add_require_option(CLI::App& command, CheckOptions& options) {
    command
        .add_option("--require", options.required,
                    "Status 1 if the verdict does not cover this; coverage: stock, holders, "
                    "fixtures, work offsets, axis limits or start position are not described")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(one_of({required_words.begin(), required_words.end()}));
}

core::Result<CheckJob> job_of(const CheckOptions& options) {
    FEELER_TRY(CheckJob job, job_of(options.what));
    job.engine = options.engine;
    for (const std::string& required : options.required)
        job.rules[required_rule(required)] = core::Severity::error;
    if (options.pairs)
        job.detail = core::Detail::every_pair;
    else if (options.verdict_only)
        job.detail = core::Detail::verdict;
    return job;
}

} // namespace app
