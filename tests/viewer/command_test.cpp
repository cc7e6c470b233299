#include <map>
#include <set>

#include <gtest/gtest.h>

#include "app/view/ui/command.h"

namespace {

using namespace app::viewer;

TEST(Command, NoKeyDoesTwoThings) {
    std::map<std::pair<int, int>, Command> seen;
    for (const KeyBinding& binding : key_bindings()) {
        const auto [entry, is_new] =
            seen.emplace(std::pair(binding.code, binding.modifiers), binding.command);
        EXPECT_TRUE(is_new) << binding.keys;
        EXPECT_EQ(command_of(binding.code, binding.modifiers), binding.command) << binding.keys;
    }
}

TEST(Command, EveryCommandIsExplainedOnce) {
    std::map<Command, int> explained;
    for (const KeyBinding& binding : key_bindings()) {
        explained[binding.command] += binding.help[0] != 0 ? 1 : 0;
        EXPECT_NE(std::string(binding.keys), "");
    }
    for (int i = 0; i <= static_cast<int>(Command::quit); ++i)
        EXPECT_EQ(explained[static_cast<Command>(i)], 1) << "command " << i;
}

TEST(Command, KeysAreThoseThatAreKnownFromElsewhere) {
    EXPECT_EQ(command_of(key::right, mod::none), Command::step);
    EXPECT_EQ(command_of(key::left, mod::shift), Command::step_back_ten);
    EXPECT_EQ(command_of(key::function(5), mod::none), Command::go_on);
    EXPECT_EQ(command_of(key::function(9), mod::none), Command::toggle_breakpoint);
    EXPECT_EQ(command_of(key::of('N'), mod::shift), Command::previous_offending);
    EXPECT_EQ(command_of(key::of('N'), mod::alt), std::nullopt);
}

TEST(Command, TipNamesTheKey) { EXPECT_EQ(tip_of(Command::next_offending), "Next problem (N)"); }

} // namespace
