#include "app/session/condition_words.h"

#include <algorithm>
#include <charconv>

#include "app/session/modal_table.h"
#include "app/session/value_text.h"
#include "core/sim/rule_table.h"

namespace app {
namespace {

using Node = Condition::Node;

struct NamedFact {
    std::string_view name;
    BlockFact fact;
    ValueType type;
};

constexpr NamedFact facts[] = {
    {"clearance", BlockFact::clearance, ValueType::number},
    {"lower", BlockFact::clearance, ValueType::number},
    {"upper", BlockFact::upper, ValueType::number},
    {"allowance", BlockFact::allowance, ValueType::number},
    {"margin", BlockFact::margin, ValueType::number},
    {"removed", BlockFact::removed, ValueType::number},
    {"duration", BlockFact::duration, ValueType::number},
    {"time", BlockFact::time, ValueType::number},
    {"block", BlockFact::block, ValueType::number},
    {"line", BlockFact::line, ValueType::number},
    {"depth", BlockFact::depth, ValueType::number},
    {"tool", BlockFact::tool, ValueType::number},
    {"motion", BlockFact::motion, ValueType::word},
    {"verdict", BlockFact::verdict, ValueType::word},
    {"file", BlockFact::file, ValueType::word},
    {"rule", BlockFact::rule, ValueType::word},
};

constexpr std::string_view motions[] = {"rapid", "feed", "arc", "cycle", "none"};
constexpr std::string_view verdicts[] = {"clear", "undecided", "violation", "collision"};
constexpr std::string_view severities[] = {"error", "warning", "note"};

bool is_in(const auto& list, std::string_view name) {
    return std::find(std::begin(list), std::end(list), name) != std::end(list);
}

/// The number behind a letter, as in t3; empty when that is not all.
std::optional<double> number_behind(char letter, const std::string& name) {
    int number = 0;
    if (name.size() < 2 || name[0] != letter) return std::nullopt;
    const char* end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + 1, end, number);
    if (read.ec != std::errc() || read.ptr != end || number < 0) return std::nullopt;
    return number;
}

/// Whether value_of tells this name as a word.
bool is_word_of_control(const std::string& name) {
    if (const ModalEntry* entry = modal_entry(name)) return entry->kind == ModalKind::word;
    std::string capitals = name;
    for (char& c : capitals)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return offset_named(capitals).has_value();
}

} // namespace

std::optional<Node> value_named(const std::string& name) {
    for (const NamedFact& fact : facts)
        if (fact.name == name)
            return Node{.kind = NodeKind::fact, .type = fact.type, .fact = fact.fact};
    if (const auto tool = number_behind('t', name))
        return Node{.kind = NodeKind::number, .number = *tool};
    if (!names_value(name)) return std::nullopt;
    return Node{.kind = NodeKind::control,
                .type = is_word_of_control(name) ? ValueType::word : ValueType::number,
                .text = name};
}

std::optional<Node> truth_named(const std::string& name) {
    constexpr ValueType truth = ValueType::truth;
    if (is_in(motions, name)) return Node{.kind = NodeKind::moves, .type = truth, .text = name};
    if (is_in(verdicts, name)) return Node{.kind = NodeKind::judged, .type = truth, .text = name};
    if (is_in(severities, name))
        return Node{.kind = NodeKind::severity, .type = truth, .text = name};
    if (name == "near") return Node{.kind = NodeKind::near, .type = truth};
    if (name == "finding") return Node{.kind = NodeKind::severity, .type = truth};
    if (core::default_severity(name))
        return Node{.kind = NodeKind::rule, .type = truth, .text = name};
    if (const auto tool = number_behind('t', name))
        return Node{.kind = NodeKind::has_tool, .type = truth, .number = *tool};
    if (number_behind('n', name))
        return Node{.kind = NodeKind::numbered, .type = truth, .text = name};
    return std::nullopt;
}

std::vector<std::string> words_for(const Node& node) {
    if (node.kind == NodeKind::fact && node.fact == BlockFact::motion)
        return {std::begin(motions), std::end(motions)};
    if (node.kind == NodeKind::fact && node.fact == BlockFact::verdict)
        return {std::begin(verdicts), std::end(verdicts)};
    if (node.kind == NodeKind::fact && node.fact == BlockFact::rule) return core::rule_names();
    const ModalEntry* entry = node.kind == NodeKind::control ? modal_entry(node.text) : nullptr;
    return entry ? words_of(*entry) : std::vector<std::string>{};
}

std::vector<std::string> condition_names() {
    std::vector<std::string> names;
    for (const NamedFact& fact : facts) names.emplace_back(fact.name);
    for (const std::string_view motion : motions) names.emplace_back(motion);
    for (const std::string_view verdict : verdicts) names.emplace_back(verdict);
    for (const std::string_view severity : severities) names.emplace_back(severity);
    names.emplace_back("finding");
    names.emplace_back("near");
    for (std::string& rule : core::rule_names()) names.push_back(std::move(rule));
    for (std::string& name : names_beginning("")) names.push_back(std::move(name));
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
}

std::vector<std::string> condition_names_beginning(const std::string& text) {
    const std::string start = lowered(text);
    std::vector<std::string> names;
    for (std::string& name : condition_names())
        if (lowered(name).starts_with(start)) names.push_back(std::move(name));
    return names;
}

} // namespace app
