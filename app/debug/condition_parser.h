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

/// The type of a part of a condition, the same for all blocks.
enum class ValueType : uint8_t { number, word, truth };

/// A fact of a block from the record.
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
    rule, // of its findings; a comparison holds if it holds for any of them
};

enum class NodeKind : uint8_t {
    number,  // `number`
    word,    // `text` literally
    fact,    // `fact` of the block
    control, // value_of `text`
    // true or false
    moves,    // the block's motion is `text`
    judged,   // its verdict is `text`, or it has a finding of this rule
    rule,     // it has a finding of the rule `text`
    near,     // its clearance is between the allowance and twice the allowance
    severity, // it has a finding of severity `text`; empty: of any
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

/// A part of a condition, with its own parts.
struct Condition::Node {
    NodeKind kind = NodeKind::number;
    ValueType type = ValueType::number;
    double number = 0.0;
    BlockFact fact = BlockFact::clearance;
    std::string text = {}; // in lower case where case does not matter
    std::vector<Node> of = {};
    uint32_t column = 0; // where it begins, from 1
};

/// The value of a condition, or of a part of it, for a block. An unknown number is empty.
using NodeValue = std::variant<std::optional<double>, InspectedValue, bool>;

/// The subject of a condition. Without a control its values are unknown.
struct Condition::Asked {
    const BlockFacts& facts;
    const gcode::InterpreterState* control = nullptr;
    const gcode::Environment* environment = nullptr;
};

/// Errors: those of value_of.
core::Result<NodeValue> value_of(const Condition::Node& node, const Condition::Asked& asked);

/// The first part that uses a value of the control; null: none.
const Condition::Node* asked_of_control(const Condition::Node& node);

/// A token of a condition's text.
struct ConditionToken {
    enum class Kind : uint8_t { end, number, name, text, sign };

    Kind kind = Kind::end;
    std::string text = {};  // a name in lower case, a sign in its shortest form, a text as written
    std::string whole = {}; // a name as written, with what follows after hyphens
    double number = 0.0;
    uint32_t column = 0; // from 1
};

/// The tokens; the last one is the end.
///
/// Errors: syntax, with the column.
core::Result<std::vector<ConditionToken>> tokens_of(std::string_view text);

/// What a name means as a number or word (`feed`: the feed rate), and as a condition (`feed`: the
/// block feeds). Empty if it has no such meaning.
std::optional<Condition::Node> value_named(const std::string& name);
std::optional<Condition::Node> truth_named(const std::string& name);

/// The words that a part may be compared with; empty: too many to list.
std::vector<std::string> words_for(const Condition::Node& node);

/// All names of the language.
std::vector<std::string> condition_names();

/// Parses a text in the language of conditions, of any type.
///
/// Errors: syntax, with the column.
core::Result<Condition::Node> parse_condition(std::string_view text);

} // namespace app
