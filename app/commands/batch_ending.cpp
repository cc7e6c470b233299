#include "app/commands/batch_ending.h"

#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include "app/commands/output.h"
#include "app/library/shard/shard.h"
#include "app/report/exchange/junit_report.h"
#include "app/report/exchange/sarif_report.h"
#include "app/report/html/html_batch.h"
#include "app/report/json/batch_report.h"

namespace app {
namespace {

std::string report_of(const BatchResult& batch, const std::string& format,
                      const BatchStyle& style) {
    std::error_code ignored;
    if (format == "json") return batch_json_report(batch);
    if (format == "jsonl") return batch_lines_report(batch);
    if (format == "csv") return batch_csv_report(batch);
    if (format == "html") return batch_html_report(batch);
    if (format == "junit") return junit_report(batch);
    if (format == "sarif")
        return sarif_report(batch, std::filesystem::current_path(ignored).string());
    return batch_text(batch, {.quiet = style.quiet, .verbose = style.verbose});
}

} // namespace

ExitCode end_batch(const BatchResult& batch, const Shard* shard,
                   const std::vector<ReportTarget>& targets, const BatchTalk& talk,
                   const ReadFiles& read) {
    bool all = true;
    for (const ReportTarget& target : targets) {
        const bool was_said = target.path.empty() && target.format == "text";
        if (was_said) continue;
        const auto written = write_output(target.path,
                                          shard && target.format == "shard"
                                              ? json_of(*shard)
                                              : report_of(batch, target.format, talk.style),
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

void BatchTalk::say(const std::string& text) const {
    std::fputs(text.c_str(), stream);
    std::fflush(stream);
}

BatchTalk talk_of(const BatchStyle& asked, const std::vector<ReportTarget>& targets) {
    BatchTalk talk{.style = asked};
    for (const ReportTarget& target : targets)
        if (target.path.empty() && target.format != "text") talk.stream = stderr;
    const char* no_colour = std::getenv("NO_COLOR");
    const bool may_colour = !no_colour || *no_colour == '\0';
    talk.style.colour = may_colour && ::isatty(::fileno(talk.stream)) == 1;
    return talk;
}

} // namespace app
