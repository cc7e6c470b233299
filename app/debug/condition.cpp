#include "app/debug/condition.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/check/check_run.h"
#include "app/debug/condition_parser.h"
#include "app/debug/inspected_value.h"
#include "core/base/text.h"
#include "core/sim/clearance.h"
#include "core/sim/finding.h"
#include "core/sim/run/simulator.h"
#include "core/sim/setup.h"
#include "core/sim/verdict.h"
#include "gcode/exec/interpreter.h"
#include "gcode/language/environment.h"

namespace app {
namespace {

void add_bodies(const CheckRun& record, const core::BlockResult& result, BlockFacts& facts) {
    for (const core::PairClearance& pair : result.pairs) {
        if (!pair.found()) continue;
        facts.bodies.push_back(core::part_name(record.setup, pair.pair));
        facts.bodies.push_back(core::body_name(record.setup, pair.pair));
    }
}

/// Adds the findings about the block, including those that were merged into another one.
void add_findings(const CheckRun& record, BlockFacts& facts) {
    const core::BlockIndex block{static_cast<uint32_t>(facts.block)};
    for (const auto* findings : {&record.findings, &record.combined_findings})
        for (const core::Finding& finding : *findings)
            if (finding.block == block) facts.findings.push_back(&finding);
}

} // namespace

BlockFacts facts_of(const CheckRun& record, size_t block, const RequiredFacts& wanted) {
    const CheckedBlock checked = record.blocks[block];
    const core::BlockResult& result = checked.result;
    BlockFacts facts;
    facts.block = block;
    facts.line = checked.line;
    facts.depth = checked.calls.size();
    facts.text = checked.text;
    facts.file = checked.file;
    facts.motion = result.motion;
    facts.tool = result.tool;
    facts.verdict = result.verdict;
    facts.removed = result.removed;
    facts.duration = result.duration;
    facts.time = result.time;
    if (result.deciding) {
        const core::PairClearance& pair = result.pairs[*result.deciding];
        facts.clearance = pair.lower;
        facts.upper = pair.upper;
        facts.allowance = pair.allowance.distance;
        facts.margin = pair.margin();
    } else if (result.checked) {
        facts.clearance = facts.upper = facts.margin = core::infinity;
    }
    if (wanted.bodies) add_bodies(record, result, facts);
    if (wanted.findings) add_findings(record, facts);
    return facts;
}

namespace {

using Node = Condition::Node;
using Number = std::optional<double>;

Number number_of(BlockFact fact, const BlockFacts& facts) {
    switch (fact) {
    case BlockFact::clearance:
        return facts.clearance;
    case BlockFact::upper:
        return facts.upper;
    case BlockFact::allowance:
        return facts.allowance;
    case BlockFact::margin:
        return facts.margin;
    case BlockFact::removed:
        return facts.removed;
    case BlockFact::duration:
        return facts.duration;
    case BlockFact::time:
        return facts.time;
    case BlockFact::block:
        return static_cast<double>(facts.block);
    case BlockFact::line:
        return facts.line;
    case BlockFact::depth:
        return static_cast<double>(facts.depth);
    default:
        return facts.tool ? Number(core::value_of(*facts.tool)) : Number();
    }
}

std::string rules_of(const BlockFacts& facts) {
    std::set<std::string> rules;
    for (const core::Finding* finding : facts.findings) rules.insert(finding->rule);
    return fmt::format("{}", fmt::join(rules, " "));
}

std::string word_of(BlockFact fact, const BlockFacts& facts) {
    if (fact == BlockFact::motion) return core::name_of(facts.motion);
    if (fact == BlockFact::file) return std::string(facts.file);
    if (fact == BlockFact::rule) return rules_of(facts);
    return facts.verdict ? core::name_of(*facts.verdict) : "unknown";
}

template <typename Predicate>
bool any_finding(const BlockFacts& facts, Predicate&& is_so) {
    return std::any_of(facts.findings.begin(), facts.findings.end(),
                       [&](const core::Finding* finding) { return is_so(*finding); });
}

bool is_about(const Node& node, const BlockFacts& facts) {
    const auto is_meant = [&](const std::string& name) {
        return core::lower_case(name) == node.text;
    };
    return std::any_of(facts.bodies.begin(), facts.bodies.end(), is_meant)
           || any_finding(facts, [&](const core::Finding& finding) {
                  return is_meant(finding.pair[0]) || is_meant(finding.pair[1]);
              });
}

/// Whether a line begins with an N word, possibly after a `/`.
bool begins_with(std::string_view text, const std::string& number) {
    const std::string line = core::lower_case(text);
    const size_t begin = line.find_first_not_of(" \t/");
    if (begin == std::string::npos || line.compare(begin, number.size(), number) != 0) return false;
    const size_t end = begin + number.size();
    return end >= line.size() || !std::isdigit(static_cast<unsigned char>(line[end]));
}

bool has_rule(const std::string& rule, const BlockFacts& facts) {
    return any_finding(facts, [&](const core::Finding& one) { return one.rule == rule; });
}

bool is_judged(const std::string& verdict, const BlockFacts& facts) {
    return facts.verdict && verdict == core::name_of(*facts.verdict);
}

bool has_severity(core::Severity severity, const BlockFacts& facts) {
    return any_finding(facts, [&](const core::Finding& one) { return one.severity == severity; });
}

/// Whether the clearance is between the allowance and twice the allowance.
bool is_near(const BlockFacts& facts) {
    const bool is_kept = facts.verdict && *facts.verdict < core::Verdict::violation
                         && !has_severity(core::Severity::error, facts);
    return is_kept && facts.clearance && facts.allowance && *facts.allowance > 0.0
           && *facts.clearance < 2.0 * *facts.allowance;
}

bool truth_of(const Node& node, const BlockFacts& facts) {
    switch (node.kind) {
    case NodeKind::moves:
        return node.text == core::name_of(facts.motion);
    case NodeKind::judged:
        return is_judged(node.text, facts) || has_rule(node.text, facts);
    case NodeKind::rule:
        return has_rule(node.text, facts);
    case NodeKind::severity:
        return any_finding(facts, [&](const core::Finding& one) {
            return node.text.empty() || node.text == core::name_of(one.severity);
        });
    case NodeKind::has_tool:
        return facts.tool && core::value_of(*facts.tool) == static_cast<int>(node.number);
    case NodeKind::near:
        return is_near(facts);
    case NodeKind::numbered:
        return begins_with(facts.text, node.text);
    case NodeKind::body:
        return is_about(node, facts);
    default: // contains
        return core::lower_case(facts.text).find(node.text) != std::string::npos;
    }
}

/// An environment for a program of which only the dialect is known.
gcode::Environment plain_environment(gcode::DialectId dialect) {
    gcode::Environment environment;
    environment.dialect = dialect;
    return environment;
}

core::Result<NodeValue> of_control(const Node& node, const Condition::Asked& asked) {
    core::Result<InspectedValue> value = InspectedValue{std::nullopt, "unknown"};
    if (asked.control && asked.environment)
        value = value_of(node.text, *asked.control, *asked.environment);
    if (!value) return tl::unexpected(value.error());
    if (node.type == ValueType::word) return NodeValue(*std::move(value));
    return NodeValue(value->number);
}

Number counted(NodeKind kind, double a, double b) {
    double result = 0.0;
    if (kind == NodeKind::add) result = a + b;
    if (kind == NodeKind::subtract) result = a - b;
    if (kind == NodeKind::multiply) result = a * b;
    if (kind == NodeKind::divide) {
        if (b == 0.0) return std::nullopt;
        result = a / b;
    }
    return std::isnan(result) ? Number() : Number(result);
}

bool are_equal(double a, double b) { return a == b || std::abs(a - b) <= core::resolution; }

bool compared(NodeKind kind, double a, double b) {
    switch (kind) {
    case NodeKind::less:
        return a < b;
    case NodeKind::less_or_equal:
        return a <= b;
    case NodeKind::equal:
        return are_equal(a, b);
    default:
        return !are_equal(a, b);
    }
}

core::Result<NodeValue> of_words(const Node& node, const NodeValue& left, const NodeValue& right) {
    const auto& value = std::get<InspectedValue>(left);
    const bool same = is_word(value, std::get<InspectedValue>(right).text);
    if (value.text == "unknown") return NodeValue(false);
    return NodeValue(same == (node.kind == NodeKind::equal));
}

core::Result<NodeValue> of_two(const Node& node, const Condition::Asked& asked) {
    FEELER_TRY(const NodeValue left, value_of(node.of[0], asked));
    if (node.kind == NodeKind::both && !std::get<bool>(left)) return NodeValue(false);
    if (node.kind == NodeKind::either && std::get<bool>(left)) return NodeValue(true);
    FEELER_TRY(const NodeValue right, value_of(node.of[1], asked));
    if (node.kind == NodeKind::both || node.kind == NodeKind::either) return right;
    if (std::holds_alternative<InspectedValue>(left)) return of_words(node, left, right);
    const auto& a = std::get<Number>(left);
    const auto& b = std::get<Number>(right);
    const bool is_sum = node.type == ValueType::number;
    if (!a || !b) return is_sum ? NodeValue(Number()) : NodeValue(false);
    if (is_sum) return NodeValue(counted(node.kind, *a, *b));
    return NodeValue(compared(node.kind, *a, *b));
}

core::Result<NodeValue> of_one(const Node& node, const Condition::Asked& asked) {
    FEELER_TRY(const NodeValue value, value_of(node.of[0], asked));
    if (node.kind == NodeKind::opposite) return NodeValue(!std::get<bool>(value));
    const auto& number = std::get<Number>(value);
    return NodeValue(number ? Number(-*number) : Number());
}

InspectedValue shown(const NodeValue& value) {
    if (const bool* truth = std::get_if<bool>(&value))
        return {std::nullopt, *truth ? "true" : "false"};
    if (const auto* word = std::get_if<InspectedValue>(&value)) return *word;
    const Number& number = std::get<Number>(value);
    if (number && std::isinf(*number)) return {std::nullopt, "beyond the search limit"};
    return quantity(number);
}

bool any_node(const Node& node, const std::function<bool(const Node&)>& is_so) {
    return is_so(node) || std::any_of(node.of.begin(), node.of.end(), [&](const Node& part) {
               return any_node(part, is_so);
           });
}

bool is_of_findings(const Node& node) {
    return node.kind == NodeKind::judged || node.kind == NodeKind::rule
           || node.kind == NodeKind::severity || node.kind == NodeKind::near
           || node.kind == NodeKind::body
           || (node.kind == NodeKind::fact && node.fact == BlockFact::rule);
}

RequiredFacts wanted_by(const Node& root) {
    return {any_node(root, [](const Node& node) { return node.kind == NodeKind::body; }),
            any_node(root, is_of_findings)};
}

core::Result<NodeValue> value_of(const Node& root, const Condition::Subject& subject,
                                 const RequiredFacts& wanted) {
    const BlockFacts facts = facts_of(subject.record, subject.block, wanted);
    if (subject.environment || !subject.control)
        return value_of(root, Condition::Asked{facts, subject.control, subject.environment});
    const gcode::Environment plain = plain_environment(subject.record.dialect);
    return value_of(root, Condition::Asked{facts, subject.control, &plain});
}

} // namespace

core::Result<NodeValue> value_of(const Node& node, const Condition::Asked& asked) {
    switch (node.kind) {
    case NodeKind::number:
        return NodeValue(Number(node.number));
    case NodeKind::word:
        return NodeValue(InspectedValue{std::nullopt, node.text});
    case NodeKind::fact:
        if (node.type == ValueType::number) return NodeValue(number_of(node.fact, asked.facts));
        return NodeValue(InspectedValue{std::nullopt, word_of(node.fact, asked.facts)});
    case NodeKind::control:
        return of_control(node, asked);
    default:
        if (node.of.size() == 2) return of_two(node, asked);
        if (node.of.size() == 1) return of_one(node, asked);
        return NodeValue(truth_of(node, asked.facts));
    }
}

const Condition::Node* control_query(const Node& node) {
    if (node.kind == NodeKind::control) return &node;
    for (const Node& part : node.of)
        if (const Node* found = control_query(part)) return found;
    return nullptr;
}

core::Result<Condition> Condition::read(std::string_view text) {
    FEELER_TRY(Node root, parse_condition(text));
    if (root.type != ValueType::truth)
        return core::fail(core::ErrorCode::syntax,
                          root.type == ValueType::number
                              ? "this is a number, not a condition: compare it, as in clearance < 1"
                              : "this is a word, not a condition: compare it, as in plane = ZX",
                          {.line = 1, .column = root.column});
    Condition condition;
    condition.text_ = std::string(text);
    if (const Node* node = control_query(root)) condition.uses_control_ = node->text;
    condition.wanted_ = wanted_by(root);
    condition.root_ = std::make_shared<const Node>(std::move(root));
    return condition;
}

bool Condition::holds(const Subject& subject) const {
    const auto value = value_of(*root_, subject, wanted_);
    return value && std::get<bool>(*value);
}

bool Condition::holds(const BlockFacts& facts) const {
    const auto value = value_of(*root_, Asked{facts});
    return value && std::get<bool>(*value);
}

core::Result<InspectedValue> evaluate(std::string_view text, const Condition::Subject& subject) {
    FEELER_TRY(const Node root, parse_condition(text));
    FEELER_TRY(const NodeValue value, value_of(root, subject, wanted_by(root)));
    return shown(value);
}

bool uses_control(std::string_view text) {
    const auto root = parse_condition(text);
    return root && control_query(*root);
}

std::string text_of(const Breakpoint& breakpoint) {
    std::string text;
    const auto add = [&](std::string part) { text += (text.empty() ? "" : ", ") + part; };
    if (breakpoint.line)
        add(breakpoint.file.empty()
                ? fmt::format("line {}", *breakpoint.line)
                : fmt::format("line {} of {}", *breakpoint.line, breakpoint.file));
    if (breakpoint.tool) add(fmt::format("change to T{}", core::value_of(*breakpoint.tool)));
    if (breakpoint.rule == "finding")
        add("any finding");
    else if (!breakpoint.rule.empty())
        add(fmt::format("finding {}", breakpoint.rule));
    if (breakpoint.condition)
        text += (text.empty() ? "if " : " if ") + breakpoint.condition->text();
    return text.empty() ? "every block" : text;
}

} // namespace app
