#include "app/report/html_batch_columns.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/batch/outcome.h"
#include "app/report/html_batch_facts.h"
#include "app/report/html_finding_columns.h"
#include "app/report/html_text.h"

namespace app {
namespace {

/// The programs of a batch, and what they share: texts and findings.
class ProgramColumns {
public:
    explicit ProgramColumns(size_t most_findings) : findings_(texts_, most_findings) {}

    void add(const ProgramResult& program, Outcome outcome);
    std::string json(const std::string& folder) const;

private:
    void add_tightest(const std::optional<Tightest>& tightest);
    void add_error(const KeptError& error);

    TextTable texts_;
    FindingColumns findings_;
    std::vector<std::string> paths_, digests_;
    NumberRuns outcome_, setup_, dialect_, engine_, pair_, assumptions_;
    std::vector<int64_t> blocks_, cycle_, removed_, seconds_, line_, block_, lower_, width_, keep_,
        assumed_;
    std::string errors_; // "[program,file,line,column,message],..."
};

void ProgramColumns::add_tightest(const std::optional<Tightest>& tightest) {
    const int64_t lower = tightest ? clearance_um(tightest->lower) : -1;
    const bool has_upper = tightest && tightest->upper;
    pair_.add(tightest ? shown_text(texts_, pair_name(tightest->pair)) : -1);
    line_.push_back(tightest ? tightest->line : 0);
    block_.push_back(tightest ? tightest->block : 0);
    lower_.push_back(lower);
    width_.push_back(has_upper ? std::max<int64_t>(um_above(*tightest->upper) - lower, 0) : -1);
    keep_.push_back(tightest ? um_above(tightest->allowance) : 0);
}

void ProgramColumns::add_error(const KeptError& error) {
    fmt::format_to(std::back_inserter(errors_), "{}[{},{},{},{},{}]", errors_.empty() ? "" : ",",
                   paths_.size() - 1, shown_text(texts_, error.file), error.line, error.column,
                   shown_text(texts_, error.message));
}

void ProgramColumns::add(const ProgramResult& program, Outcome outcome) {
    paths_.push_back(program.program);
    digests_.push_back(program.sha256);
    outcome_.add(static_cast<int64_t>(outcome));
    setup_.add(shown_text(texts_, program.setup));
    dialect_.add(shown_text(texts_, program.dialect));
    engine_.add(shown_text(texts_, program.engine));
    blocks_.push_back(static_cast<int64_t>(program.blocks));
    cycle_.push_back(steps_of(program.cycle_time, 1e-3));
    removed_.push_back(steps_of(program.removed, 1.0));
    seconds_.push_back(steps_of(program.seconds, 1e-3));
    add_tightest(program.tightest);
    if (program.error) add_error(*program.error);
    assumptions_.add(static_cast<int64_t>(program.assumptions.size()));
    for (const std::string& assumption : program.assumptions)
        assumed_.push_back(shown_text(texts_, assumption));
    findings_.add(program);
}

std::string ProgramColumns::json(const std::string& folder) const {
    std::string json =
        fmt::format(R"({{"count":{},"folder":{},"path":)", paths_.size(), script_string(folder));
    json += string_array(paths_) + R"(,"sha256":)" + string_array(digests_) + R"(,"outcome":)"
            + outcome_.json() + R"(,"setup":)" + setup_.json() + R"(,"dialect":)" + dialect_.json()
            + R"(,"engine":)" + engine_.json() + R"(,"blocks":)" + number_array(blocks_)
            + R"(,"cycle":)" + number_array(cycle_) + R"(,"removed":)" + number_array(removed_)
            + R"(,"seconds":)" + number_array(seconds_);
    json += R"(,"pair":)" + pair_.json() + R"(,"line":)" + number_array(line_) + R"(,"block":)"
            + number_array(block_) + R"(,"lower":)" + number_array(lower_) + R"(,"width":)"
            + number_array(width_) + R"(,"keep":)" + number_array(keep_) + R"(,"errors":[)"
            + errors_ + R"(],"assumptions":)" + assumptions_.json() + R"(,"assumed":)"
            + number_array(assumed_) + R"(,"texts":)" + texts_.json();
    return json + R"(,"findings":)" + findings_.json() + "}";
}

std::string columns_json(const BatchResult& batch, size_t most_findings) {
    ProgramColumns columns(most_findings);
    for (const ProgramResult& program : batch.programs) columns.add(program, outcome_of(program));
    for (const std::string& program : batch.unchecked)
        columns.add({.program = program}, Outcome::unchecked);
    return columns.json(common_folder(batch));
}

/// How many findings there are, if of each program at most so many count.
size_t kept_findings(const BatchResult& batch, size_t most) {
    size_t count = 0;
    for (const ProgramResult& program : batch.programs)
        count += std::min(program.findings.size(), most);
    return count;
}

} // namespace

std::string batch_columns_json(const BatchResult& batch) {
    constexpr size_t most_bytes = 18'000'000, most_in_all = 200'000;
    size_t most = 1'000; // of a program
    while (most > 1 && kept_findings(batch, most) > most_in_all) most /= 2;
    std::string json = columns_json(batch, most);
    for (; most > 1 && json.size() > most_bytes; json = columns_json(batch, most)) most /= 2;
    return json;
}

} // namespace app
