#include "app/session/condition.h"

#include <algorithm>
#include <cmath>

#include "app/session/condition_node.h"
#include "app/session/condition_parser.h"
#include "app/session/value_text.h"
#include "core/sim/verdict.h"

namespace app {
namespace {

using Node = Condition::Node;
using Number = std::optional<double>;

const CheckedBlock& block_of(const Condition::Subject& subject) {
    return subject.record.blocks[subject.block];
}

const core::PairClearance* deciding_pair(const core::BlockResult& result) {
    return result.deciding ? &result.pairs[*result.deciding] : nullptr;
}

Number number_of(BlockFact fact, const Condition::Subject& subject) {
    const CheckedBlock& block = block_of(subject);
    const core::BlockResult& result = block.result;
    const core::PairClearance* pair = deciding_pair(result);
    const Number far = result.checked ? Number(core::infinity) : Number(); // else nobody knows
    switch (fact) {
    case BlockFact::clearance:
        return pair ? pair->lower : far;
    case BlockFact::upper:
        return pair ? pair->upper : far;
    case BlockFact::allowance:
        return pair ? Number(pair->allowance.distance) : Number();
    case BlockFact::margin:
        return pair ? pair->margin() : far;
    case BlockFact::removed:
        return result.removed;
    case BlockFact::duration:
        return result.duration;
    case BlockFact::time:
        return result.time;
    case BlockFact::block:
        return static_cast<double>(subject.block);
    case BlockFact::line:
        return block.line;
    case BlockFact::depth:
        return static_cast<double>(block.calls.size());
    default:
        return result.tool ? Number(core::value_of(*result.tool)) : Number();
    }
}

std::string word_of(BlockFact fact, const CheckedBlock& block) {
    if (fact == BlockFact::motion) return core::name_of(block.result.motion);
    if (fact == BlockFact::verdict) return core::name_of(block.result.verdict);
    return block.file;
}

/// Whether any finding of the block is so, be it told with another one. While a record grows, its
/// findings are in no order.
template <typename Predicate>
bool any_finding(const Condition::Subject& subject, Predicate&& is_so) {
    const core::BlockIndex block{static_cast<uint32_t>(subject.block)};
    const auto is_meant = [&](const core::Finding& finding) {
        return finding.block == block && is_so(finding);
    };
    const auto& findings = subject.record.findings;
    const auto& taken_in = subject.record.taken_in;
    return std::any_of(findings.begin(), findings.end(), is_meant)
           || std::any_of(taken_in.begin(), taken_in.end(), is_meant);
}

bool is_about(const Node& node, const Condition::Subject& subject) {
    const CheckRun& record = subject.record;
    for (const core::PairClearance& pair : block_of(subject).result.pairs) {
        if (!pair.found()) continue;
        if (lowered(core::part_name(record.setup, pair.pair)) == node.text) return true;
        if (lowered(core::body_name(record.setup, pair.pair)) == node.text) return true;
    }
    return any_finding(subject, [&](const core::Finding& finding) {
        return lowered(finding.pair[0]) == node.text || lowered(finding.pair[1]) == node.text;
    });
}

/// Whether a line begins with an N word; it may stand behind a `/`.
bool begins_with(std::string line, const std::string& number) {
    line = lowered(line);
    const size_t begin = line.find_first_not_of(" \t/");
    if (begin == std::string::npos || line.compare(begin, number.size(), number) != 0) return false;
    const size_t end = begin + number.size();
    return end >= line.size() || !std::isdigit(static_cast<unsigned char>(line[end]));
}

bool has_rule(const std::string& rule, const Condition::Subject& subject) {
    return any_finding(subject, [&](const core::Finding& one) { return one.rule == rule; });
}

bool truth_of(const Node& node, const Condition::Subject& subject) {
    const CheckedBlock& block = block_of(subject);
    const core::BlockResult& result = block.result;
    switch (node.kind) {
    case NodeKind::moves:
        return node.text == core::name_of(result.motion);
    case NodeKind::judged:
        return node.text == core::name_of(result.verdict) || has_rule(node.text, subject);
    case NodeKind::rule:
        return has_rule(node.text, subject);
    case NodeKind::severity:
        return any_finding(subject, [&](const core::Finding& one) {
            return node.text.empty() || node.text == core::name_of(one.severity);
        });
    case NodeKind::has_tool:
        return result.tool && core::value_of(*result.tool) == static_cast<int>(node.number);
    case NodeKind::numbered:
        return begins_with(block.text, node.text);
    case NodeKind::body:
        return is_about(node, subject);
    default: // contains
        return lowered(block.text).find(node.text) != std::string::npos;
    }
}

/// The environment of a program of which nothing but the dialect is known.
gcode::Environment plain_environment(gcode::DialectId dialect) {
    gcode::Environment environment;
    environment.dialect = dialect;
    return environment;
}

core::Result<NodeValue> of_control(const Node& node, const Condition::Subject& subject) {
    core::Result<InspectedValue> value = InspectedValue{std::nullopt, "unknown"};
    if (subject.control && subject.environment)
        value = value_of(node.text, *subject.control, *subject.environment);
    else if (subject.control)
        value = value_of(node.text, *subject.control, plain_environment(subject.record.dialect));
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

core::Result<NodeValue> of_two(const Node& node, const Condition::Subject& subject) {
    FEELER_TRY(const NodeValue left, value_of(node.of[0], subject));
    if (node.kind == NodeKind::both && !std::get<bool>(left)) return NodeValue(false);
    if (node.kind == NodeKind::either && std::get<bool>(left)) return NodeValue(true);
    FEELER_TRY(const NodeValue right, value_of(node.of[1], subject));
    if (node.kind == NodeKind::both || node.kind == NodeKind::either) return right;
    if (std::holds_alternative<InspectedValue>(left)) return of_words(node, left, right);
    const auto& a = std::get<Number>(left);
    const auto& b = std::get<Number>(right);
    const bool is_sum = node.type == ValueType::number;
    if (!a || !b) return is_sum ? NodeValue(Number()) : NodeValue(false);
    if (is_sum) return NodeValue(counted(node.kind, *a, *b));
    return NodeValue(compared(node.kind, *a, *b));
}

core::Result<NodeValue> of_one(const Node& node, const Condition::Subject& subject) {
    FEELER_TRY(const NodeValue value, value_of(node.of[0], subject));
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

} // namespace

core::Result<NodeValue> value_of(const Node& node, const Condition::Subject& subject) {
    switch (node.kind) {
    case NodeKind::number:
        return NodeValue(Number(node.number));
    case NodeKind::word:
        return NodeValue(InspectedValue{std::nullopt, node.text});
    case NodeKind::fact:
        if (node.type == ValueType::number) return NodeValue(number_of(node.fact, subject));
        return NodeValue(InspectedValue{std::nullopt, word_of(node.fact, block_of(subject))});
    case NodeKind::control:
        return of_control(node, subject);
    default:
        if (node.of.size() == 2) return of_two(node, subject);
        if (node.of.size() == 1) return of_one(node, subject);
        return NodeValue(truth_of(node, subject));
    }
}

bool asks_control(const Node& node) {
    return node.kind == NodeKind::control
           || std::any_of(node.of.begin(), node.of.end(),
                          [](const Node& part) { return asks_control(part); });
}

core::Result<Condition> Condition::read(std::string_view text) {
    FEELER_TRY(Node root, parse_condition(text));
    if (root.type != ValueType::truth)
        return core::fail(core::ErrorCode::syntax,
                          root.type == ValueType::number
                              ? "this is a number and no question: compare it, as in clearance < 1"
                              : "this is a word and no question: compare it, as in plane = ZX",
                          {.line = 1, .column = root.column});
    Condition condition;
    condition.text_ = std::string(text);
    condition.asks_control_ = app::asks_control(root);
    condition.root_ = std::make_shared<const Node>(std::move(root));
    return condition;
}

bool Condition::holds(const Subject& subject) const {
    const auto value = value_of(*root_, subject);
    return value && std::get<bool>(*value);
}

core::Result<InspectedValue> evaluate(std::string_view text, const Condition::Subject& subject) {
    FEELER_TRY(const Node root, parse_condition(text));
    FEELER_TRY(const NodeValue value, value_of(root, subject));
    return shown(value);
}

bool asks_control(std::string_view text) {
    const auto root = parse_condition(text);
    return root && asks_control(*root);
}

} // namespace app
