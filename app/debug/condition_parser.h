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

/// The type of an expression in a condition; it does not depend on the block.
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
    rule, // of the findings; a comparison holds if it holds for one of them
};

enum class NodeKind : uint8_t {
    number,  // `number`
    word,    // `text` literally
    fact,    // `fact` of the block
    control, // the value of the control called `text`
    // true or false
    moves,    // the block's motion is `text`
    judged,   // the block's verdict is `text`, or it has a finding of this rule
    rule,     // the block has a finding of the rule `text`
    near,     // the clearance is between the allowance and twice the allowance
    severity, // the block has a finding of severity `text`; empty: any severity
    has_tool, // the block's tool is `number`
    numbered, // the block begins with `text`, an N word
    body,     // the body `text` is in one of the block's pairs or findings
    contains, // the block's line contains `text`
    // operators with one or two operands
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

/// A node of the expression tree of a condition.
struct Condition::Node {
    NodeKind kind = NodeKind::number;
    ValueType type = ValueType::number;
    double number = 0.0;
    BlockFact fact = BlockFact::clearance;
    std::string text = {}; // in lower case if case is ignored
    std::vector<Node> of = {};
    uint32_t column = 0; // where its text begins, from 1
};

/// The value of a node for a block. An unknown number is empty.
using NodeValue = std::variant<std::optional<double>, InspectedValue, bool>;

/// What a condition is evaluated for. Without a control, its values are unknown.
struct Condition::Asked {
    const BlockFacts& facts;
    const gcode::InterpreterState* control = nullptr;
    const gcode::Environment* environment = nullptr;
};

/// Evaluates a node.
///
/// Errors: those of value_of for values of the control.
core::Result<NodeValue> value_of(const Condition::Node& node, const Condition::Asked& asked);

/// The first node that uses a value of the control; null: none.
const Condition::Node* control_query(const Condition::Node& node);

/// A token of the text of a condition.
struct ConditionToken {
    enum class Kind : uint8_t { end, number, name, text, sign };

    Kind kind = Kind::end;
    std::string text = {};  // a name in lower case, a normalised operator, a text as written
    std::string whole = {}; // a name as written, with all parts joined by hyphens
    double number = 0.0;
    uint32_t column = 0; // from 1
};

/// The tokens of a text; the last one has the kind `end`.
///
/// Errors: syntax, with the column.
core::Result<std::vector<ConditionToken>> tokens_of(std::string_view text);

/// The meaning of a name as a number or word (`feed`: the feed rate), and as a condition (`feed`:
/// the block is a feed move). Empty if it has no such meaning.
std::optional<Condition::Node> value_named(const std::string& name);
std::optional<Condition::Node> truth_named(const std::string& name);

/// The words with which a node may be compared; empty: too many to list.
std::vector<std::string> words_for(const Condition::Node& node);

/// All names of the condition language.
std::vector<std::string> condition_names();

/// Parses an expression of the condition language, of any type.
///
/// Errors: syntax, with the column.
core::Result<Condition::Node> parse_condition(std::string_view text);

} // namespace app
