#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "app/debug/condition.h"
#include "core/base/result.h"

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

/// A piece of a condition's text.
struct ConditionToken {
    enum class Kind : uint8_t { end, number, name, text, sign };

    Kind kind = Kind::end;
    std::string text = {};  // a name in small letters, a sign in its shortest form, a text as it is
    std::string whole = {}; // of a name: with what follows behind hyphens, as it was written
    double number = 0.0;
    uint32_t column = 0; // from 1
};

/// The pieces, the last of which is the end.
///
/// Errors: syntax, with the column.
core::Result<std::vector<ConditionToken>> tokens_of(std::string_view text);

/// What a name means where a number or word is wanted (`feed` of the control), and where something
/// true or false is (`feed`: the block feeds). Empty where it means nothing of the kind.
std::optional<Condition::Node> value_named(const std::string& name);
std::optional<Condition::Node> truth_named(const std::string& name);

/// The words that a part may be compared with; empty where there are too many to list.
std::vector<std::string> words_for(const Condition::Node& node);

/// Every name that is listed somewhere.
std::vector<std::string> condition_names();

/// What a text in the language of conditions means, of whatever type.
///
/// Errors: syntax, with the column.
core::Result<Condition::Node> parse_condition(std::string_view text);

} // namespace app
