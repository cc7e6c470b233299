#include <gtest/gtest.h>

#include "app/view/model/settings.h"

namespace {

using namespace app::viewer;

TEST(ViewerSettings, ComeBackAsTheyWere) {
    Settings settings;
    settings.theme = render::ColorScheme::light;
    settings.inch = true;
    settings.system_dialog = false;
    settings.scale = 1.25;
    settings.mouse = MousePreset::middle_pans;
    settings.projection = render::Projection::orthographic;
    settings.shown.machine = false;
    settings.width = 1000;
    settings.x = 12;
    settings.list_width = 401.5;
    settings.device_width = 345.5;
    EXPECT_EQ(settings_in(text_of(settings)), settings);
    EXPECT_EQ(settings_in(text_of(Settings())), Settings());
}

TEST(ViewerSettings, NonsenseIsAsIfItWasNotThere) {
    EXPECT_EQ(settings_in(""), Settings());
    EXPECT_EQ(settings_in("width = ["), Settings());
    EXPECT_EQ(settings_in("width = -5\nscale = 900.0\nmouse = 17\ntheme = \"pink\""), Settings());
    EXPECT_EQ(settings_in("width = \"wide\"\nlist_width = nan"), Settings());
}

} // namespace
