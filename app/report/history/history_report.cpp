#include "app/report/history/history_report.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/clearance_text.h"
#include "app/base/findings.h"
#include "app/base/text.h"
#include "app/base/version.h"
#include "app/library/result/batch_result.h"
#include "app/library/result/program_diff.h"
#include "app/report/text/diff_report.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t microseconds = 1'000'000; // per second

/// The previous version checked with the same set-up and options; null if there is none.
const StoredVersion* before(const std::vector<StoredVersion>& versions, size_t index) {
    const StoredVersion& asked = versions[index];
    while (index-- > 0)
        if (versions[index].setup == asked.setup && versions[index].options == asked.options)
            return &versions[index];
    return nullptr;
}

std::string time_text(const char* form, int64_t seconds) {
    return fmt::format(fmt::runtime(form), fmt::gmtime(static_cast<std::time_t>(seconds)));
}

std::string minute_text(int64_t seconds) { return time_text("{:%Y-%m-%d %H:%M}", seconds); }

std::string nearest_text(const ProgramResult& result) {
    if (!result.tightest) return "no pair of bodies within the search limit";
    const Tightest& tightest = *result.tightest;
    if (has_only_contact(result))
        return fmt::format("permitted contact only: {} / {}, line {}", trimmed(tightest.pair[0]),
                           trimmed(tightest.pair[1]), tightest.line);
    return fmt::format("{} mm {} / {}, line {}",
                       clearance_text({true, tightest.lower, tightest.upper, tightest.allowance},
                                      ClearanceStyle::column),
                       trimmed(tightest.pair[0]), trimmed(tightest.pair[1]), tightest.line);
}

std::string change_text(const ProgramChange& change) {
    std::string text;
    constexpr double least = 0.0005; // below this it would be shown as 0
    if (change.nearer && std::abs(*change.nearer) >= least)
        text += fmt::format("    least margin {:.3f} mm {}\n", std::abs(*change.nearer),
                            *change.nearer > 0.0 ? "less" : "more");
    if (std::abs(change.longer) >= 0.05)
        text += fmt::format("    {:.1f} s {}\n", std::abs(change.longer),
                            change.longer > 0.0 ? "longer" : "shorter");
    for (const StoredFinding& finding : change.new_findings)
        text += "    new:  " + finding_line(finding) + "\n";
    for (const StoredFinding& finding : change.gone_findings)
        text += "    gone: " + finding_line(finding) + "\n";
    return text.empty() ? "    no other change\n" : text;
}

std::string version_text(const StoredVersion& stored, const StoredVersion* earlier) {
    const ProgramResult& result = stored.result;
    const std::string checked = minute_text(stored.checked_at);
    const std::string seen = minute_text(stored.seen_at / microseconds);
    std::string text = fmt::format("{} UTC  {}\n", checked,
                                   result.error ? "NOT RUN TO ITS END" : headline_of(result));
    if (const std::string uncovered = uncovered_text(result); !uncovered.empty())
        text += wrapped("unchecked: " + uncovered, 4, 2);
    if (seen != checked) text += fmt::format("    last seen {} UTC\n", seen);
    text += fmt::format("    {}\n    {}, {}\n", nearest_text(result),
                        duration_text(result.cycle_time), counts_text(result.findings));
    text +=
        fmt::format("    program {}, {}; Feeler {}\n", result.sha256.substr(0, 8),
                    stored.setup.empty() ? "set-up inferred" : "set-up " + trimmed(stored.setup),
                    stored.version.substr(0, stored.version.find(' ')));
    return earlier ? text + change_text(change_between(earlier->result, result)) : text;
}

Json change_json(const ProgramChange& change) {
    return {{"nearer", change.nearer ? Json(*change.nearer) : Json(nullptr)},
            {"longer", change.longer},
            {"verdict_differs", change.verdict_differs},
            {"new_findings", findings_json(change.new_findings)},
            {"gone_findings", findings_json(change.gone_findings)}};
}

} // namespace

std::string history_text(const std::string& program, const std::vector<StoredVersion>& versions) {
    std::string text =
        fmt::format("{}: {}\n", trimmed(program), counted(versions.size(), "version"));
    for (size_t i = 0; i < versions.size(); ++i)
        text += "\n" + version_text(versions[i], before(versions, i));
    return printable(text);
}

std::string history_json(const std::string& program, const std::vector<StoredVersion>& versions) {
    Json json = {{"feeler", version},
                 {"schema", 1},
                 {"program", utf8_text(program)},
                 {"versions", Json::array()}};
    for (size_t i = 0; i < versions.size(); ++i) {
        const StoredVersion& stored = versions[i];
        const StoredVersion* earlier = before(versions, i);
        json["versions"].push_back(
            {{"checked_at", time_text("{:%Y-%m-%dT%H:%M:%SZ}", stored.checked_at)},
             {"seen_at", time_text("{:%Y-%m-%dT%H:%M:%SZ}", stored.seen_at / microseconds)},
             {"feeler", stored.version},
             {"setup", utf8_text(stored.setup)},
             {"options", Json::parse(stored.options)},
             {"inputs", stored.inputs},
             {"result", Json::parse(json_of(stored.result))},
             {"change", earlier ? change_json(change_between(earlier->result, stored.result))
                                : Json(nullptr)}});
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace app
