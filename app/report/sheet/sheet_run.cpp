#include "app/report/sheet/sheet_run.h"

#include <atomic>
#include <memory>

#include "app/base/sha256.h"
#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/report/sheet/html_sheet.h"
#include "app/tolerance/tolerances.h"
#include "core/base/file_reads.h"

namespace app {
namespace {

std::string setup_text_of(const CheckJob& job) {
    if (job.setup_text) return *job.setup_text;
    return job.setup.empty() ? std::string() : core::file_bytes(job.setup).value_or(std::string());
}

/// The content of the sheet of this very program: it may have been saved again since the check.
core::Result<SheetContent> content_of(const CheckJob& job, const CheckRun& run) {
    FEELER_TRY(const PreparedCheck check, read_check(job));
    if (check.run.sha256 == run.sha256) {
        const std::string text = setup_text_of(job);
        SheetContent content = sheet_content(check, text);
        if (!text.empty()) content.setup_sha256 = sha256_of(text);
        content.has_unsaved_edits = job.setup_text && core::file_bytes(job.setup) != text;
        if (content.has_unsaved_edits && job.setup.empty()) content.sheet.path.clear();
        return content;
    }
    return tl::unexpected<core::Error>(
        {core::ErrorCode::io, {}, "was changed while it was checked: try again", job.program});
}

core::Result<void> add_tolerances(const CheckJob& job, const SheetWishes& wishes, CheckRun& run,
                                  SheetContent& content) {
    std::atomic<bool> was_stopped = false;
    const auto goes_on = [&](double) {
        if (!wishes.goes_on()) was_stopped = true;
        return !was_stopped;
    };
    FEELER_TRY(Tolerances tolerances, tolerances_of(job, run, goes_on));
    run.tolerances = std::make_shared<const Tolerances>(std::move(tolerances));
    content.tolerances_were_stopped = was_stopped;
    return {};
}

} // namespace

core::Result<MadeSheet> make_sheet(const CheckJob& job, const SheetWishes& wishes) {
    FEELER_TRY(CheckRun run, run_check(job));
    if (run.stopped) return tl::unexpected(*run.stopped);
    FEELER_TRY(SheetContent content, content_of(job, run));
    content.program_date = wishes.program_date;
    content.check_date = wishes.check_date;
    if (wishes.tolerances)
        if (const auto added = add_tolerances(job, wishes, run, content); !added)
            return tl::unexpected(added.error());
    content.pictures = wishes.pictures ? sheet_pictures(run.setup, zeros_of(content))
                                       : SheetPictures{.missing = "they were not wanted"};
    return MadeSheet{html_sheet(run, content), run.has_errors(), content.tolerances_were_stopped};
}

} // namespace app
