#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/base/text.h"
#include "app/base/version.h"
#include "app/library/result/batch_result.h"
#include "app/library/result/stored_json.h"
#include "app/report/json/json_report.h"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* batch_column_names =
    "program,setup,sha256,dialect,verdict,status,errors,warnings,notes,blocks,cycle_time,removed,"
    "tightest_line,lower,upper,allowance,part,body,seconds,error,headline,"
    "uncovered\r\n";

/// The cells from `tightest_line` to `body`.
std::string tightest_cells(const std::optional<Tightest>& tightest) {
    if (!tightest) return ",,,,,";
    return fmt::format("{},{},{},{},{},{}", tightest->line, tightest->lower,
                       tightest->upper ? fmt::format("{}", *tightest->upper) : std::string(),
                       tightest->allowance, csv_cell(tightest->pair[0]),
                       csv_cell(tightest->pair[1]));
}

std::string error_cell(const ProgramResult& program) {
    if (!program.error) return {};
    const StoredError& error = *program.error;
    const std::string file = error.file.empty() ? program.program : error.file;
    return csv_cell(error.line == 0 ? fmt::format("{}: {}", file, error.message)
                                    : fmt::format("{}:{}: {}", file, error.line, error.message));
}

std::string row_of(const ProgramResult& program) {
    using core::Severity;
    return fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{:.6f},{:.6f},{},{:.6f},{},{},{}\r\n",
        csv_cell(program.program), csv_cell(program.setup), program.sha256, program.dialect,
        core::name_of(program.verdict), status_of(program), count_of(program, Severity::error),
        count_of(program, Severity::warning), count_of(program, Severity::note), program.blocks,
        program.cycle_time, program.removed, tightest_cells(program.tightest), program.seconds,
        error_cell(program), csv_cell(headline_of(program)), csv_cell(uncovered_text(program)));
}

} // namespace

std::string batch_json_report(const BatchResult& batch) {
    // The programs are JSON texts already: parsing them again would cost more than writing them
    // did.
    std::string text =
        fmt::format("{{\"feeler\":\"{}\",\"schema\":1,\"status\":{},\n\"programs\":[", version,
                    status_of(batch));
    for (size_t i = 0; i < batch.programs.size(); ++i)
        text += (i == 0 ? "\n" : ",\n") + json_of(batch.programs[i]);
    Json skipped = Json::array();
    for (const SkippedFile& file : batch.skipped)
        skipped.push_back({{"file", file.path}, {"why", file.why}});
    if (!batch.shard.empty())
        text += "\n],\n\"share\":" + json_text(batch.shard);
    else
        text += "\n]";
    return text
           + fmt::format(",\n\"unchecked\":{},\n\"skipped\":{}}}\n", json_text(batch.unchecked),
                         json_text(skipped));
}

std::string batch_lines_report(const BatchResult& batch) {
    std::string text;
    for (const ProgramResult& program : batch.programs) text += json_of(program) + "\n";
    for (const std::string& program : batch.unchecked)
        text += json_text({{"program", program}, {"checked", false}}) + "\n";
    return text;
}

std::string batch_csv_report(const BatchResult& batch) {
    std::string text = batch_column_names;
    for (const ProgramResult& program : batch.programs) text += row_of(program);
    for (const std::string& program : batch.unchecked)
        text += csv_cell(program) + ",,,,not checked,2,,,,,,,,,,,,,,,,\r\n";
    return text;
}

} // namespace app
