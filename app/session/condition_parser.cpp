#include "app/session/condition_parser.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/session/condition_lexer.h"
#include "app/session/condition_words.h"
#include "app/session/value_text.h"
#include "core/base/nearest_name.h"

namespace app {
namespace {

using Node = Condition::Node;
using Kind = ConditionToken::Kind;

constexpr int deepest = 100; // brackets within brackets

const char* name_of(ValueType type) {
    switch (type) {
    case ValueType::number:
        return "a number";
    case ValueType::word:
        return "a word";
    default:
        return "true or false";
    }
}

Node joined(NodeKind kind, ValueType type, Node left, Node right) {
    const uint32_t column = left.column;
    Node node{.kind = kind, .type = type, .column = column};
    node.of.push_back(std::move(left));
    node.of.push_back(std::move(right));
    return node;
}

Node made_of(NodeKind kind, ValueType type, Node one, uint32_t column) {
    Node node{.kind = kind, .type = type, .column = column};
    node.of.push_back(std::move(one));
    return node;
}

/// Recursive descent: or, and, not, comparisons, sums, products, single values.
class Parser {
public:
    explicit Parser(std::vector<ConditionToken> tokens) : tokens_(std::move(tokens)) {}

    core::Result<Node> whole() {
        if (now().kind == Kind::end)
            return refuse(now(), "there is no condition; write one as clearance < 1 and rapid");
        FEELER_TRY(Node node, either());
        if (now().kind == Kind::end) return node;
        if (is_sign(")") || is_sign("]")) return refuse(now(), "this bracket was never opened");
        return refuse(now(), "here 'and' or 'or' is missing, or a comparison");
    }

private:
    const ConditionToken& now() const { return tokens_[at_]; }
    bool is_sign(std::string_view sign) const {
        return now().kind == Kind::sign && now().text == sign;
    }
    bool take(std::string_view sign) {
        if (!is_sign(sign)) return false;
        ++at_;
        return true;
    }

    static tl::unexpected<core::Error> refuse(uint32_t column, std::string why) {
        return core::fail(core::ErrorCode::syntax, std::move(why), {.line = 1, .column = column});
    }
    static tl::unexpected<core::Error> refuse(const ConditionToken& token, std::string why) {
        return refuse(token.column, std::move(why));
    }

    static core::Result<void> want_truth(const Node& node) {
        if (node.type == ValueType::truth) return {};
        return refuse(node.column,
                      fmt::format("this is {} and no question: compare it, as in {}",
                                  name_of(node.type),
                                  node.type == ValueType::word ? "plane = ZX" : "clearance < 1"));
    }
    static core::Result<void> want_number(const Node& node) {
        if (node.type == ValueType::number) return {};
        return refuse(node.column,
                      node.type == ValueType::word
                          ? "a word can only be compared with = and !="
                          : "this is true or false and no number: join it with 'and' or 'or'");
    }

    core::Result<Node> either() {
        FEELER_TRY(Node left, both());
        while (take("or")) {
            FEELER_TRY(Node right, both());
            FEELER_TRY(left, join(NodeKind::either, std::move(left), std::move(right)));
        }
        return left;
    }

    core::Result<Node> both() {
        FEELER_TRY(Node left, opposite());
        while (take("and")) {
            FEELER_TRY(Node right, opposite());
            FEELER_TRY(left, join(NodeKind::both, std::move(left), std::move(right)));
        }
        return left;
    }

    static core::Result<Node> join(NodeKind kind, Node left, Node right) {
        for (const Node* node : {&left, &right})
            if (auto wanted = want_truth(*node); !wanted) return tl::unexpected(wanted.error());
        return joined(kind, ValueType::truth, std::move(left), std::move(right));
    }

    core::Result<Node> opposite() {
        const uint32_t column = now().column;
        if (!take("not")) return comparison();
        if (++depth_ > deepest) return refuse(column, "this is nested too deeply");
        FEELER_TRY(Node node, opposite());
        --depth_;
        if (auto wanted = want_truth(node); !wanted) return tl::unexpected(wanted.error());
        return made_of(NodeKind::opposite, ValueType::truth, std::move(node), column);
    }

    bool is_comparison(const ConditionToken& token) const {
        return token.kind == Kind::sign
               && (token.text == "<" || token.text == "<=" || token.text == ">"
                   || token.text == ">=" || token.text == "=" || token.text == "!=");
    }

    /// Also a chain: 0 < z < 5 is 0 < z and z < 5.
    core::Result<Node> comparison() {
        is_compared_ = in_sum_ || is_compared_ahead();
        FEELER_TRY(Node left, sum());
        if (!is_comparison(now())) return left;
        std::optional<Node> all;
        while (is_comparison(now())) {
            const std::string sign = now().text;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, left.type == ValueType::word ? word_for(left) : sum());
            FEELER_TRY(Node one, compared(sign, left, right));
            if (all)
                all = joined(NodeKind::both, ValueType::truth, *std::move(all), std::move(one));
            else
                all = std::move(one);
            left = std::move(right);
        }
        return *std::move(all);
    }

    /// Whether the value that begins here is compared or counted with, so that `feed` is a number.
    bool is_compared_ahead() const {
        size_t at = at_;
        while (tokens_[at].kind == Kind::sign && tokens_[at].text == "-") ++at;
        if (tokens_[at].kind != Kind::name) return false;
        const ConditionToken& behind = tokens_[at + 1];
        return is_comparison(behind)
               || (behind.kind == Kind::sign && std::string_view("+-*/").find(behind.text) < 4);
    }

    /// A block may have findings of several rules.
    static Node compared_rule(const std::string& sign, const Node& left, const Node& right) {
        Node rule{.kind = NodeKind::rule,
                  .type = ValueType::truth,
                  .text = right.text,
                  .column = left.column};
        if (sign == "=") return rule;
        return made_of(NodeKind::opposite, ValueType::truth, std::move(rule), left.column);
    }

    static core::Result<Node> compared(const std::string& sign, Node left, Node right) {
        const bool words = left.type == ValueType::word && right.type == ValueType::word;
        if (!words || (sign != "=" && sign != "!="))
            for (const Node* node : {&left, &right})
                if (auto wanted = want_number(*node); !wanted)
                    return tl::unexpected(wanted.error());
        if (left.kind == NodeKind::fact && left.fact == BlockFact::rule && words)
            return compared_rule(sign, left, right);
        const bool turned = sign[0] == '>';
        const NodeKind kind = sign == "="        ? NodeKind::equal
                              : sign == "!="     ? NodeKind::not_equal
                              : sign.size() == 2 ? NodeKind::less_or_equal
                                                 : NodeKind::less;
        if (turned) std::swap(left, right);
        return joined(kind, ValueType::truth, std::move(left), std::move(right));
    }

    /// What a word is compared with: a text, or a name that stands for itself.
    core::Result<Node> word_for(const Node& left) {
        const ConditionToken token = now();
        if (token.kind != Kind::text && token.kind != Kind::name && token.kind != Kind::number)
            return refuse(token, "here a word is missing, or a text in quotes");
        ++at_;
        const std::string text =
            token.kind == Kind::number ? number_text(token.number) : token.text;
        const std::vector<std::string> words = words_for(left);
        const bool is_one =
            words.empty() || std::any_of(words.begin(), words.end(), [&](const std::string& word) {
                return lowered(word) == lowered(text);
            });
        if (!is_one)
            return refuse(token, fmt::format("this is never '{}'; it may be {}", text,
                                             fmt::join(words, ", ")));
        return Node{.kind = NodeKind::word,
                    .type = ValueType::word,
                    .text = lowered(text),
                    .column = token.column};
    }

    core::Result<Node> sum() {
        FEELER_TRY(Node left, product());
        while (is_sign("+") || is_sign("-")) {
            const NodeKind kind = is_sign("+") ? NodeKind::add : NodeKind::subtract;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, product());
            FEELER_TRY(left, counted(kind, std::move(left), std::move(right)));
        }
        return left;
    }

    core::Result<Node> product() {
        FEELER_TRY(Node left, signed_value());
        while (is_sign("*") || is_sign("/")) {
            const NodeKind kind = is_sign("*") ? NodeKind::multiply : NodeKind::divide;
            ++at_;
            is_compared_ = true;
            FEELER_TRY(Node right, signed_value());
            FEELER_TRY(left, counted(kind, std::move(left), std::move(right)));
        }
        return left;
    }

    static core::Result<Node> counted(NodeKind kind, Node left, Node right) {
        for (const Node* node : {&left, &right})
            if (auto wanted = want_number(*node); !wanted) return tl::unexpected(wanted.error());
        return joined(kind, ValueType::number, std::move(left), std::move(right));
    }

    core::Result<Node> signed_value() {
        const uint32_t column = now().column;
        if (take("+")) return signed_value_within(column);
        if (!take("-")) return single();
        is_compared_ = true;
        FEELER_TRY(Node node, signed_value_within(column));
        if (auto wanted = want_number(node); !wanted) return tl::unexpected(wanted.error());
        return made_of(NodeKind::negate, ValueType::number, std::move(node), column);
    }

    core::Result<Node> signed_value_within(uint32_t column) {
        if (++depth_ > deepest) return refuse(column, "this is nested too deeply");
        FEELER_TRY(Node node, signed_value());
        --depth_;
        return node;
    }

    core::Result<Node> single() {
        const ConditionToken token = now();
        if (token.kind == Kind::sign && (token.text == "(" || token.text == "[")) return bracket();
        if (take("~")) return text_of_line(token.column);
        if (token.kind == Kind::end)
            return refuse(token, "here the condition ends too early: a value is missing");
        if (token.kind == Kind::sign)
            return refuse(token, fmt::format("here a value is missing before '{}'", token.text));
        ++at_;
        if (token.kind == Kind::number)
            return Node{.kind = NodeKind::number, .number = token.number, .column = token.column};
        if (token.kind == Kind::text)
            return Node{.kind = NodeKind::body,
                        .type = ValueType::truth,
                        .text = lowered(token.text),
                        .column = token.column};
        return named(token);
    }

    core::Result<Node> bracket() {
        const ConditionToken open = now();
        ++at_;
        if (++depth_ > deepest) return refuse(open, "this is nested too deeply");
        const bool outer = std::exchange(in_sum_, is_compared_);
        FEELER_TRY(Node node, either());
        is_compared_ = std::exchange(in_sum_, outer);
        --depth_;
        const std::string_view closing = open.text == "(" ? ")" : "]";
        if (!take(closing))
            return refuse(now(), fmt::format("here the '{}' of the bracket in column {} is missing",
                                             closing, open.column));
        return node;
    }

    core::Result<Node> text_of_line(uint32_t column) {
        const ConditionToken token = now();
        if (token.kind != Kind::text && token.kind != Kind::name)
            return refuse(token, "behind ~ belongs a text, as in ~ \"G81\"");
        ++at_;
        return Node{.kind = NodeKind::contains,
                    .type = ValueType::truth,
                    .text = lowered(token.text),
                    .column = column};
    }

    core::Result<Node> named(const ConditionToken& token) const {
        std::optional<Node> truth = truth_named(token.text), value = value_named(token.text);
        const bool as_value = value && (is_compared_ || is_comparison(now()) || !truth);
        // What is true or false has nothing taken from it: near-mis is a name, and a wrong one.
        const bool has_tail =
            !as_value && !token.whole.empty() && lowered(token.whole) != token.text;
        if (has_tail) return unknown(token);
        std::optional<Node> node = as_value ? std::move(value) : std::move(truth);
        if (!node) return unknown(token);
        node->column = token.column;
        return *std::move(node);
    }

    static tl::unexpected<core::Error> unknown(const ConditionToken& token) {
        const std::string written = token.whole.empty() ? token.text : token.whole;
        return refuse(token, fmt::format("'{}' is nothing that can be asked; the nearest name is "
                                         "'{}'",
                                         written,
                                         core::nearest_name(lowered(written), condition_names())));
    }

    std::vector<ConditionToken> tokens_;
    size_t at_ = 0;
    int depth_ = 0;
    bool is_compared_ = false; // names mean numbers where they can
    bool in_sum_ = false;      // likewise for all of a bracket
};

} // namespace

core::Result<Node> parse_condition(std::string_view text) {
    FEELER_TRY(std::vector<ConditionToken> tokens, tokens_of(text));
    return Parser(std::move(tokens)).whole();
}

} // namespace app
