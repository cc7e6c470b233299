#include "tests/app/checked.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace app_test {
namespace {

using Json = nlohmann::json;

template <typename T>
std::optional<T> maybe(const Json& json, const char* key) {
    if (!json.contains(key) || json[key].is_null()) return std::nullopt;
    return json[key].get<T>();
}

PairLine pair_line(const Json& json) {
    PairLine pair;
    if (const auto names = maybe<std::vector<std::string>>(json, "pair"))
        pair.name = names->at(0) + " " + names->at(1);
    if (json.contains("clearance")) {
        pair.lower = json["clearance"]["lower"];
        pair.upper = maybe<double>(json["clearance"], "upper");
    }
    pair.allowance = maybe<double>(json, "allowance");
    pair.at = maybe<double>(json, "at");
    pair.verdict = json["verdict"];
    return pair;
}

BlockLine block_line(const Json& json) {
    BlockLine block{json["block"],
                    json["line"],
                    json["text"],
                    json["motion"],
                    json["verdict"],
                    json["time"],
                    json["duration"],
                    json["removed"],
                    maybe<int>(json, "tool"),
                    pair_line(json),
                    {}};
    for (const Json& pair : json["pairs"]) block.pairs.push_back(pair_line(pair));
    return block;
}

void read_report(const std::string& text, Checked& checked) {
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) {
        ADD_FAILURE() << "no JSON: " << text.substr(0, 200) << "\nstderr: " << checked.err;
        return;
    }
    checked.verdict = json["verdict"];
    for (const Json& block : json["blocks"]) checked.blocks.push_back(block_line(block));
    for (const Json& finding : json["findings"])
        checked.findings.push_back({finding["rule"], finding["severity"], finding["message"],
                                    finding["cure"], maybe<int>(finding, "line")});
    checked.assumptions = json["assumptions"].get<std::vector<std::string>>();
}

} // namespace

PairLine BlockLine::pair(const std::string& name) const {
    for (const PairLine& pair : pairs)
        if (pair.name == name) return pair;
    ADD_FAILURE() << "line " << line << " has no pair " << name;
    return {};
}

BlockLine Checked::at_line(int line) const {
    for (const BlockLine& block : blocks)
        if (block.line == line) return block;
    ADD_FAILURE() << "there is no block of line " << line << "; stderr: " << err;
    return {};
}

FindingLine Checked::finding(const std::string& rule) const {
    for (const FindingLine& finding : findings)
        if (finding.rule == rule) return finding;
    ADD_FAILURE() << "no " << rule << " among: " << errors();
    return {};
}

std::string Checked::of_severity(const std::string& severity) const {
    std::string text;
    for (const FindingLine& finding : findings) {
        if (finding.severity != severity) continue;
        if (!text.empty()) text += ", ";
        text += finding.rule;
        if (finding.line) text += " " + std::to_string(*finding.line);
    }
    return text;
}

std::string Checked::errors() const { return of_severity("error"); }

test_support::Ran feeler(std::vector<std::string> words, const std::string& before) {
    words.insert(words.begin(), FEELER_BINARY);
    return test_support::run(words, before);
}

Checked check_files(const std::string& program, const std::string& setup,
                    const std::vector<std::string>& more) {
    std::vector<std::string> words = {"check", program, "--format", "json", "--pairs"};
    if (!setup.empty()) words.insert(words.end(), {"--setup", setup});
    words.insert(words.end(), more.begin(), more.end());
    const test_support::Ran ran = feeler(words);
    Checked checked;
    checked.status = ran.status;
    checked.err = ran.err;
    read_report(ran.out, checked);
    return checked;
}

Checked check(const test_support::SetupWriter& setup, const std::string& program,
              const std::vector<std::string>& more) {
    const test_support::ScopedFolder folder;
    return check_files(folder.write("program.nc", program),
                       folder.write("setup.toml", setup.text()), more);
}

void expect_encloses(const PairLine& pair, double truth, double within) {
    ASSERT_TRUE(pair.upper) << pair.name;
    EXPECT_LE(pair.lower, truth + 1e-9) << pair.name;
    EXPECT_GE(*pair.upper, truth - 1e-9) << pair.name;
    EXPECT_NEAR(pair.lower, truth, within) << pair.name;
    EXPECT_NEAR(*pair.upper, truth, within) << pair.name;
}

} // namespace app_test
