#pragma once

#include <variant>
#include <vector>

#include "app/session/condition.h"

namespace app {

/// What a part of a condition is, whatever the block.
enum class ValueType : uint8_t { number, word, truth };

/// What the record tells of a block.
enum class BlockFact : uint8_t {
    // numbers
    clearance,
    upper,
    allowance,
    margin,
    removed,
    duration,
    time,
    block,
    line,
    depth,
    tool,
    // words
    motion,
    verdict,
    file,
    rule, // of its findings: compared, it is any of them
};

enum class NodeKind : uint8_t {
    number,  // `number`
    word,    // `text` as it stands
    fact,    // `fact` of the block
    control, // value_of `text`
    // true or false
    moves,    // the block's motion is `text`
    judged,   // its verdict is `text`, or it has a finding of that rule
    rule,     // it has a finding of the rule `text`
    near,     // it keeps its allowance, but not twice
    severity, // it has a finding of the severity `text`; of any where it is empty
    has_tool, // its tool is `number`
    numbered, // it begins with `text`, an N word
    body,     // the body `text` is one of a pair or finding
    contains, // its line has `text`
    // of one or two
    negate,
    add,
    subtract,
    multiply,
    divide,
    less,
    less_or_equal,
    equal,
    not_equal,
    both,
    either,
    opposite,
};

/// A part of a condition with what it is made of.
struct Condition::Node {
    NodeKind kind = NodeKind::number;
    ValueType type = ValueType::number;
    double number = 0.0;
    BlockFact fact = BlockFact::clearance;
    std::string text = {}; // in small letters where case does not matter
    std::vector<Node> of = {};
    uint32_t column = 0; // where it begins, from 1
};

/// What a condition, or a part of it, is worth of a block. A number is empty when nobody knows it.
using NodeValue = std::variant<std::optional<double>, InspectedValue, bool>;

/// What a condition is asked about; of the control, what is not there is unknown.
struct Condition::Asked {
    const BlockFacts& facts;
    const gcode::InterpreterState* control = nullptr;
    const gcode::Environment* environment = nullptr;
};

/// Errors: those of value_of.
core::Result<NodeValue> value_of(const Condition::Node& node, const Condition::Asked& asked);

/// The first part that asks the control for something, or nothing.
const Condition::Node* asked_of_control(const Condition::Node& node);

} // namespace app
