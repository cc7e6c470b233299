#include "tests/support/program_generator.h"

#include <algorithm>
#include <sstream>

namespace test_support {
namespace {

std::vector<ProgramFeature> all_features() {
    std::vector<ProgramFeature> all;
    for (const auto& some : {motion_features(), offset_features(), cycle_features(),
                             action_features(), language_features(), flow_features()})
        all.insert(all.end(), some.begin(), some.end());
    return all;
}

std::vector<std::string> lines_of(const std::string& program) {
    std::vector<std::string> lines;
    std::istringstream stream(program);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// Splits a line before each letter; sufficient for programs that are to be damaged.
std::vector<std::string> words_of(const std::string& line) {
    std::vector<std::string> words(1);
    for (const char c : line) {
        if (c >= 'A' && c <= 'Z' && !words.back().empty() && words.back().back() == ' ')
            words.emplace_back();
        words.back() += c;
    }
    return words;
}

void spoil(std::vector<std::string>& words, ProgramText& random) {
    const auto at = static_cast<size_t>(random.whole(0, static_cast<int>(words.size()) - 1));
    std::string& word = words[at];
    switch (random.whole(0, 6)) {
    case 0:
        words.erase(words.begin() + static_cast<long>(at));
        break;
    case 1:
        words.push_back(" " + word);
        break;
    case 2:
        word[0] = "ABCDFGHIJKLMPQRSTXYZ"[random.whole(0, 19)];
        break;
    case 3:
        word = fmt::format("{}{} ", word[0], random.one_of({"-1", "0", "99", "1.5", "-0.25", "7"}));
        break;
    case 4:
        if (const size_t bracket = word.find_first_of("[]()<>"); bracket != std::string::npos)
            word.erase(bracket, 1);
        else
            word += random.one_of({"[1", "]", "#", "-", "..", "e3 "});
        break;
    case 5:
        word += random.one_of({" G41", " G2", " G81", " G4", " G92", " G28", " G10", " M3 M4"});
        break;
    default:
        word +=
            random.one_of({" R5", " P2.5", " L0", " Q-2", " H50", " D3", " K1", " S-5", " T77"});
        break;
    }
}

} // namespace

const std::vector<ProgramFeature>& program_features() {
    static const std::vector<ProgramFeature> features = all_features();
    return features;
}

std::string generated_program(const std::string& feature, uint32_t seed, int blocks) {
    const auto& features = program_features();
    const auto found = std::find_if(features.begin(), features.end(),
                                    [&](const auto& one) { return one.name == feature; });
    if (found == features.end() && feature != "everything") return {};
    ProgramText text(seed);
    text.line("{}", text.one_of({"G21", "G21", "G20"}));
    text.line("G90 G17 G40 G94 G0 F{}", text.whole(20, 900));
    for (int i = 0; i < blocks; ++i) {
        const auto any = static_cast<size_t>(text.whole(0, static_cast<int>(features.size()) - 1));
        (found == features.end() ? features[any] : *found).write(text);
        text.move();
    }
    text.line("M{}", text.one_of({2, 2, 30}));
    return text.text();
}

std::string spoilt_program(const std::string& program, uint32_t seed) {
    ProgramText random(seed);
    std::vector<std::string> lines = lines_of(program);
    const int last = static_cast<int>(lines.size()) - 2; // keep the end
    if (last < 1) return program;
    const auto at = static_cast<size_t>(random.whole(1, last));
    if (random.once_in(8)) {
        std::swap(lines[at], lines[static_cast<size_t>(random.whole(1, last))]);
    } else {
        std::vector<std::string> words = words_of(lines[at]);
        spoil(words, random);
        lines[at].clear();
        for (const std::string& word : words) lines[at] += word;
    }
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

} // namespace test_support
