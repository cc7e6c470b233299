#include <cstdlib>

#include <gtest/gtest.h>

#include "app/view/ui/system_dialog.h"

namespace {

using namespace app::viewer;

TEST(SystemDialog, ReadsTheUrisOfFiles) {
    EXPECT_EQ(path_of_uri("file:///a/b%20c.nc"), "/a/b c.nc");
    EXPECT_EQ(path_of_uri("file://host/a%C3%A9%e9"), "/a\xC3\xA9\xE9");
    EXPECT_EQ(path_of_uri("file:///50%"), "/50%");
    EXPECT_EQ(path_of_uri("file:///50%2"), "/50%2");
    EXPECT_EQ(path_of_uri("file:///%zz%"), "/%zz%");
    EXPECT_FALSE(path_of_uri("file:///a%00b"));
    EXPECT_FALSE(path_of_uri("file://"));
    EXPECT_FALSE(path_of_uri("http://x/a"));
    EXPECT_FALSE(path_of_uri(""));
}

TEST(SystemDialog, IsAbsentWithoutABus) {
    ::unsetenv("DBUS_SESSION_BUS_ADDRESS");
    EXPECT_TRUE(ask_system({}, [] { return false; }).is_absent);
    ::setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nowhere", 1);
    EXPECT_TRUE(ask_system({}, [] { return false; }).is_absent);
    ::setenv("DBUS_SESSION_BUS_ADDRESS", "nonsense", 1);
    EXPECT_TRUE(ask_system({}, [] { return false; }).is_absent);
    ::unsetenv("DBUS_SESSION_BUS_ADDRESS");
}

} // namespace
