#include "tests/session/walked_program.h"

#include <regex>

#include <nlohmann/json.hpp>

#include "app/check/block_runner.h"
#include "app/check/check_run.h"
#include "app/check/prepared_check.h"
#include "app/check/run_state.h"
#include "app/report/json/json_report.h"

namespace session_test {

ProgramFiles::ProgramFiles(const std::string& name, const std::string& text,
                           const test_support::SetupWriter& writer)
    : program(folder.write(name, text)), setup(folder.write("setup.toml", writer.text())) {}

app::CheckJob ProgramFiles::job() const {
    app::CheckJob job;
    job.program = program;
    job.setup = setup;
    return job;
}

std::string walked_program() {
    return R"(o<square> sub
  G0 X#1 Y#2
  G1 Z#3 F300
  G1 X[#1 + 20]
  G3 X[#1 + 20] Y[#2 + 20] J10 I0
  o<corner> call [#1] [#2]
  G1 X#1
  G1 Y#2
  G0 Z5
o<square> endsub
o<corner> sub
  #<_corners> = [#<_corners> + 1]
  G1 X[#1 + 10] Y[#2 + 22]
o<corner> endsub
G21 G90 G17 G54
#<_corners> = 0
T1 M6
G43 H1
S2000 M3
G0 X10 Y10
G0 Z5
#100 = 0
o100 while [#100 lt 18]
  #101 = [10 + [#100 MOD 6] * 10]
  o<square> call [#101] [10 + #100] [0 - 1 - #100 / 4]
  #100 = [#100 + 1]
o100 endwhile
G4 P0.5
G0 Z60
T2 M6
G43 H2
S2000 M3
G64 P0.02
#100 = 0
o110 while [#100 lt 60]
  G0 Z[5 - #100 / 20]
  G1 X[10 + #100] Y[70 - #100 / 3] F500
  G1 Z[-2 - #100 / 10]
  #100 = [#100 + 1]
o110 endwhile
G0 Z5
G0 X110 Y50
G1 Z-20 F500
G0 Z50
G81 X20 Y20 Z-5 R2 F100
X40
X60
G80
M2
)";
}

test_support::SetupWriter walked_setup() {
    return test_support::SetupWriter()
        .root("mesh_size = 2.0")
        .program("dialect = \"linuxcnc\"\nstart = { X = -350, Y = -200, Z = 0 }")
        .lengths("[[length_offset]]\nnumber = 1\nlength = 95.0\n[[length_offset]]\nnumber = 2\n"
                 "length = 95.0")
        .also_tool("number = 2\nshape = \"ball\"\ndiameter = 8\nflute_length = 20\n"
                   "shank = [[8, 8, 25]]\nholder = [[40, 40, 50]]\n")
        .fixture("clamp-1", "box = [[102, 40, -30], [130, 60, 5]]\n");
}

std::vector<uint64_t> digests_of(const app::CheckJob& job) {
    auto check = app::prepare_check(job);
    if (!check) return {};
    app::BlockRunner runner(*check);
    app::RunState state = app::start_of_program(check->file.environment, check->run.setup,
                                                std::move(*check->machine));
    std::vector<uint64_t> digests = {app::digest_of(state)};
    while (true) {
        const auto step = runner.step(state);
        if (!step || !*step) return digests;
        digests.push_back(app::digest_of(state));
    }
}

std::string report_of(const app::CheckRun& run) {
    auto report = nlohmann::json::parse(app::json_report(run, false));
    report["statistics"].erase("seconds");
    report["statistics"].erase("memory");
    return report.dump(1);
}

std::string report_before(const app::CheckRun& run, size_t block) {
    const auto report = nlohmann::json::parse(app::json_report(run, false));
    std::string before;
    for (const auto& entry : report["blocks"])
        if (entry["block"] < block) before += entry.dump() + "\n";
    for (const auto& finding : report["findings"])
        if (finding["block"].is_number() && finding["block"] < block)
            before += finding.dump() + "\n";
    return before;
}

} // namespace session_test
