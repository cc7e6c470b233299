#include "tests/support/program_generator.h"

namespace test_support {
namespace {

void body(ProgramText& text, int depth);

std::string condition(ProgramText& text) {
    return fmt::format("[#<n> {} {}]", text.one_of({"LT", "GT", "EQ", "NE", "LE", "GE"}),
                       text.whole(-3, 6));
}

void branch(ProgramText& text, int depth) {
    const int label = text.label();
    text.line("o{} if {}", label, condition(text));
    body(text, depth - 1);
    for (int i = text.whole(0, 2); i > 0; --i) {
        text.line("o{} elseif {}", label, condition(text));
        body(text, depth - 1);
    }
    if (text.once_in(2)) {
        text.line("O{} ELSE", label);
        body(text, depth - 1);
    }
    text.line("o{} endif", label);
}

/// The reference does not leave a `repeat` early; after a `break` of a `while` or a `continue` of a
/// `do` it miscounts the next loop.
void leave_or_go_on(ProgramText& text, int label, const char* how) {
    const int test = text.label();
    text.line("o{} if {}", test, condition(text));
    text.line("  o{} {}", label, how);
    text.line("o{} endif", test);
}

/// Loops have their own counter parameters, so that they end.
void counted_loop(ProgramText& text, int depth) {
    const int label = text.label(), counter = 100 + label;
    const int times = text.whole(0, 4);
    text.line("#{}=0", counter);
    switch (text.whole(0, 2)) {
    case 0:
        text.line("o{} while [#{} LT {}]", label, counter, times);
        text.line("#{0}=[#{0}+1]", counter);
        body(text, depth - 1);
        if (text.once_in(2)) leave_or_go_on(text, label, "continue");
        text.line("o{} endwhile", label);
        break;
    case 1:
        text.line("o{} do", label);
        text.line("#{0}=[#{0}+1]", counter);
        body(text, depth - 1);
        if (text.once_in(2)) leave_or_go_on(text, label, "break");
        text.line("o{} while [#{} LT {}]", label, counter, times);
        break;
    default:
        text.line("o<loop {}> repeat [{}]", label, text.one_of({"0", "1", "3", "2.4", "#<n>"}));
        body(text, depth - 1);
        text.line("o<loop{}> endrepeat", label);
    }
}

void body(ProgramText& text, int depth) {
    text.line("G1 X#<n> Y[{}]", text.label());
    text.line("#<n>=[#<n>{}{}]", text.one_of({"+", "-"}), text.whole(0, 3));
    if (depth <= 0 || text.once_in(3)) return;
    if (text.once_in(2))
        branch(text, depth);
    else
        counted_loop(text, depth);
}

void branches(ProgramText& text) {
    text.line("#<n>={}", text.whole(-4, 7));
    branch(text, 2);
}

void loops(ProgramText& text) {
    text.line("#<n>={}", text.whole(-4, 7));
    counted_loop(text, 2);
}

void subprograms(ProgramText& text) {
    const int label = text.label();
    const std::string name =
        text.once_in(2) ? fmt::format("{}", label) : fmt::format("<sub {}>", label);
    text.line("o{} sub", name);
    text.line("G1 X#1 Y#2 Z#3");
    text.line("#1=[#1+1] #30=5 #31=[#31+1] #<_shared>=#1");
    if (text.once_in(3)) {
        text.line("o{} if [#1 GT 0]", label + 1000);
        text.line("o{} return [#1*2]", name);
        text.line("o{} endif", label + 1000);
    }
    text.line("o{} endsub {}", name, text.once_in(2) ? "[#1+#2]" : "");
    text.line("#1={} #2={} #<_shared>=0", text.length(), text.length());
    text.line("o{} call [{}] [#1{}]{}", name, text.length(), text.one_of({"", "+1", "*2"}),
              text.once_in(2) ? " [7]" : "");
    text.line("G1 X#1 Y[#2] Z#31 A#<_value> B#<_value_returned> C#<_shared>");
}

void recursion(ProgramText& text) {
    const int label = text.label();
    text.line("o{} sub", label);
    text.line("#2=1");
    text.line("o{} if [#1 GT 1]", label + 2000);
    text.line("o{} call [#1-1]", label);
    text.line("#2=[#1*#<_value>]");
    text.line("o{} endif", label + 2000);
    text.line("G1 X#1 Y[#2 MOD 100]");
    text.line("o{} endsub [#2]", label);
    text.line("o{} call [{}]", label, text.whole(0, 6));
    text.line("G1 X[#<_value> MOD 100] Y#1");
}

/// Several subprograms that call one another, skipped where they are defined.
void nested_calls(ProgramText& text) {
    const int inner = text.label(), outer = text.label();
    text.line("o{} sub", inner);
    text.line("#<own>=[#1*2]");
    text.line("G1 X#<own> Y#2");
    text.line("o{} endsub [#<own>]", inner);
    text.line("o{} sub", outer);
    text.line("#<own>=#1");
    text.line("o{} call [#<own>] [#2]", inner);
    text.line("G1 X#<own> Y#<_value> Z#1");
    text.line("o{} endsub", outer);
    text.line("#<own>={}", text.length());
    for (int i = text.whole(1, 3); i > 0; --i)
        text.line("o{} call [{}] [{}]", outer, text.length(), text.length());
    text.line("G1 X#<own> Y#<_value> Z#<_value_returned>");
}

} // namespace

std::vector<ProgramFeature> flow_features() {
    return {{"branches", branches},
            {"loops", loops},
            {"subprograms", subprograms},
            {"recursion", recursion},
            {"nested_calls", nested_calls}};
}

} // namespace test_support
