#include "app/commands/batch_ending.h"

#include "app/commands/output.h"
#include "app/commands/report_formats.h"
#include "app/library/shard/shard.h"

namespace app {

ExitCode end_batch(const BatchResult& batch, const Shard* shard,
                   const std::vector<ReportTarget>& targets, const BatchOutput& talk,
                   const ReadFiles& read) {
    bool all = true;
    for (const ReportTarget& target : targets) {
        const bool was_said = target.path.empty() && target.format == "text";
        if (was_said) continue;
        const auto written =
            write_output(target.path,
                         shard && target.format == "shard"
                             ? json_of(*shard)
                             : report_format(target.format).of_batch(batch, talk.style),
                         read);
        if (!written) print_error(written.error());
        all = all && written.has_value();
    }
    if (std::ferror(talk.stream) != 0) {
        const char* const name = talk.stream == stdout ? "standard output" : "standard error";
        print_error({core::ErrorCode::io, {}, "cannot be written", name});
        all = false;
    }
    return all ? static_cast<ExitCode>(status_of(batch)) : ExitCode::failed;
}

void BatchOutput::say(const std::string& text) const {
    std::fputs(text.c_str(), stream);
    std::fflush(stream);
}

BatchOutput output_for(const BatchStyle& asked, const std::vector<ReportTarget>& targets) {
    BatchOutput talk{.style = asked};
    for (const ReportTarget& target : targets)
        if (target.path.empty() && target.format != "text") talk.stream = stderr;
    talk.style.colour = terminal_style(talk.stream).colour;
    return talk;
}

} // namespace app
