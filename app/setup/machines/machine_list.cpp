#include "app/setup/machines/machine_data.h"
#include "core/base/units.h"

namespace app {
namespace {

constexpr double in = core::mm_per_inch;

// --- sources ---

constexpr std::string_view pathpilot_source =
    "Travels, rapids and accelerations: the configuration of Tormach's PathPilot for this machine "
    "(github.com/jbarillaro-vt/tormach-pcnc1100, operator, configs).";
constexpr std::string_view linuxcnc_source =
    "Travels, rapids and accelerations: LinuxCNC's configuration for this machine "
    "(github.com/LinuxCNC/linuxcnc, configs/by_machine); its author may have adapted it.";
constexpr std::string_view sample_source =
    "Travels, rapids and accelerations: a simulated machine of LinuxCNC "
    "(github.com/LinuxCNC/linuxcnc, configs/sim/axis/vismach/5axis).";
constexpr std::string_view gsender_source =
    "Travels: the machine profiles of gSender, whose maker is Sienci Labs "
    "(github.com/Sienci-Labs/gsender, defaultMachineProfiles.js).";
constexpr std::string_view shapeoko_source =
    "Travels: the readme of github.com/OrotavaHackerspace/CNC; X and Y also on "
    "shapeokoenthusiasts.gitbook.io.";
constexpr std::string_view desktop_source = "Travels, distance from nose to table and table: "
                                            "nano.nau.edu/About_Equipment/Haas_DesktopMill.html.";
constexpr std::string_view haas_source =
    "Travels, distance from nose to table and table: second-hand, from a machine shop's table of "
    "Haas's figures for VF-2, VF-4 and VF-5; compare them with yours.";
constexpr std::string_view d2m_source =
    "Travels, tilt and table: second-hand, from the machine descriptions of "
    "github.com/buvi-org/d2m, machines; compare them with yours.";
constexpr std::string_view generic_source = "No make: all sizes are typical. Measure yours.";

// --- where zero is ---

constexpr std::string_view corner_zero =
    "Taken to be at the upper right rear end of the travels, which is also the home position.";
constexpr std::string_view left_zero =
    "At the upper left rear end of the travels, which is also the home position: as in the "
    "configuration.";
constexpr std::string_view front_zero =
    "At the upper left front end of the travels, which is also the home position: as in the "
    "configuration.";
constexpr std::string_view config_zero = "Within the travels, as in the configuration.";
constexpr std::string_view grbl_zero =
    "Taken to be at the upper right rear end of the travels, where Grbl has it after homing. A "
    "machine without limit switches has it where it was switched on.";

constexpr AxisData below_zero(double travel, std::optional<double> rapid = {},
                              std::optional<double> acceleration = {}) {
    return {-travel, 0.0, rapid, acceleration};
}

constexpr AxisData above_zero(double travel, std::optional<double> rapid = {},
                              std::optional<double> acceleration = {}) {
    return {0.0, travel, rapid, acceleration};
}

void add_routers(std::vector<MachineData>& list) {
    const auto grbl = [&](std::string_view name, std::string_view title, std::string_view source,
                          double x, double y, double z) {
        list.push_back({name, MachineKind::router, title, "ROUTER", source, grbl_zero,
                        below_zero(x), below_zero(y), below_zero(z)});
    };
    grbl("longmill-mk2-12x30", "Sienci LongMill MK2 12x30", gsender_source, 792, 345, 114.3);
    grbl("longmill-mk2-30x30", "Sienci LongMill MK2 30x30", gsender_source, 792, 845, 114.3);
    grbl("longmill-mk2-48x30", "Sienci LongMill MK2 48x30", gsender_source, 1279.9, 845, 114.3);
    grbl("sienci-mill-one", "Sienci Mill One V3", gsender_source, 258, 185, 90);
    grbl("onefinity", "Onefinity, 32 inch", gsender_source, 819.15, 819.15, 113.35);
    grbl("shapeoko-3-xl", "Shapeoko 3 XL", shapeoko_source, 33 * in, 16 * in, 3 * in);
    list.push_back({"tormach-xstech", MachineKind::router, "Tormach xsTECH router", "ROUTER",
                    pathpilot_source, left_zero, above_zero(8.8 * in, 120 * in, 200 * in),
                    below_zero(6.5 * in, 120 * in, 200 * in),
                    below_zero(2.5 * in, 120 * in, 200 * in)});
    list.push_back({"generic-router", MachineKind::router, "Router, 600 x 900", "ROUTER",
                    generic_source, grbl_zero, below_zero(600, 5000), below_zero(900, 5000),
                    below_zero(100, 2500), 160, 700, 1000});
}

void add_bench_mills(std::vector<MachineData>& list) {
    const auto tormach = [&](std::string_view name, std::string_view title, std::string_view taper,
                             const AxisData& x, const AxisData& y, const AxisData& z) {
        list.push_back(
            {name, MachineKind::bench_mill, title, taper, pathpilot_source, left_zero, x, y, z});
    };
    tormach("tormach-440", "Tormach PCNC 440", "R8", above_zero(10 * in, 135 * in, 15 * in),
            below_zero(6.25 * in, 135 * in, 15 * in), below_zero(10 * in, 110 * in, 15 * in));
    tormach("tormach-770m", "Tormach 770M", "R8", above_zero(14 * in, 135 * in, 15 * in),
            below_zero(7.5 * in, 135 * in, 15 * in), below_zero(13.25 * in, 110 * in, 15 * in));
    tormach("tormach-1100-3", "Tormach PCNC 1100 series 3", "R8",
            above_zero(18 * in, 110 * in, 15 * in), below_zero(9.5 * in, 110 * in, 15 * in),
            below_zero(16.25 * in, 90 * in, 15 * in));
    tormach("tormach-1100mx", "Tormach 1100MX", "BT30", above_zero(18 * in, 300 * in, 30 * in),
            below_zero(11 * in, 300 * in, 30 * in), below_zero(16.25 * in, 230 * in, 19.167 * in));
    const AxisData short_axis{-11.8 * in, 0.2 * in, 300 * in, 7.5 * in};
    list.push_back({"smithy-1240",
                    MachineKind::bench_mill,
                    "Smithy 1240",
                    "",
                    linuxcnc_source,
                    config_zero,
                    {-21.8 * in, 0.2 * in, 300 * in, 7.5 * in},
                    short_axis,
                    short_axis});
    list.push_back({"haas-desktop-mill", MachineKind::bench_mill, "Haas Desktop Mill", "ROUTER",
                    desktop_source, corner_zero, below_zero(152), below_zero(254), below_zero(76),
                    80, 460, 270});
    list.push_back({"generic-bench-mill", MachineKind::bench_mill, "Bench mill, 300 x 200", "R8",
                    generic_source, corner_zero, below_zero(300, 2500), below_zero(200, 2500),
                    below_zero(250, 2000), 320, 550, 160});
}

void add_mills(std::vector<MachineData>& list) {
    list.push_back({"bridgeport-boss", MachineKind::knee_mill, "Bridgeport BOSS, Z is the quill",
                    "", linuxcnc_source, front_zero, above_zero(18 * in, 120 * in, 10 * in),
                    above_zero(12 * in, 120 * in, 10 * in),
                    below_zero(4.75 * in, 120 * in, 10 * in)});
    list.push_back({"generic-knee-mill", MachineKind::knee_mill, "Knee mill, Z is the quill", "R8",
                    generic_source, corner_zero, below_zero(700, 3000), below_zero(300, 3000),
                    below_zero(120, 2000), 300, 1070, 230});
    const auto mill = [&](std::string_view name, std::string_view title, std::string_view source,
                          std::optional<double> rapid, double x, double y, double z, double nose,
                          double length, double width) {
        list.push_back({name, MachineKind::vertical, title, "CAT40", source, corner_zero,
                        below_zero(x, rapid), below_zero(y, rapid), below_zero(z, rapid), nose,
                        length, width});
    };
    mill("haas-vf-2", "Haas VF-2", haas_source, {}, 762, 406, 508, 610, 914, 356);
    mill("haas-vf-4", "Haas VF-4", haas_source, {}, 1270, 508, 635, 742, 1321, 457);
    mill("haas-vf-5", "Haas VF-5", haas_source, {}, 1270, 660, 635, 742, 1372, 610);
    mill("generic-vmc-500", "Vertical machining centre, 500 x 400", generic_source, 30000, 500, 400,
         450, 600, 650, 400);
    mill("generic-vmc-800", "Vertical machining centre, 800 x 500", generic_source, 30000, 800, 500,
         500, 620, 950, 500);
    mill("generic-vmc-1200", "Vertical machining centre, 1200 x 600", generic_source, 24000, 1200,
         600, 600, 750, 1350, 600);
    list.push_back({"generic-hmc",
                    MachineKind::horizontal,
                    "Horizontal machining centre, pallet of 400",
                    "CAT40",
                    generic_source,
                    corner_zero,
                    below_zero(560, 30000),
                    below_zero(500, 30000),
                    below_zero(500, 30000),
                    {},
                    400,
                    400,
                    {},
                    {'B', {0, 0, 9000, {}}}});
}

void add_five_axis_machines(std::vector<MachineData>& list) {
    const auto trunnion = [&](std::string_view name, std::string_view title, std::string_view taper,
                              std::string_view source, std::optional<double> rapid, double x,
                              double y, double z, RotaryData tilt, std::optional<double> diameter) {
        list.push_back({name,
                        MachineKind::trunnion,
                        title,
                        taper,
                        source,
                        corner_zero,
                        below_zero(x, rapid),
                        below_zero(y, rapid),
                        below_zero(z, rapid),
                        {},
                        {},
                        {},
                        tilt,
                        {'C', {}},
                        diameter});
    };
    trunnion("haas-umc-750", "Haas UMC-750", "CAT40", d2m_source, {}, 762, 508, 508,
             {'B', {-35, 120, {}, {}}}, 500);
    trunnion("dmg-dmu-50", "DMG MORI DMU 50", "", d2m_source, {}, 500, 450, 400,
             {'B', {-35, 110, {}, {}}}, {});
    trunnion("generic-trunnion", "Five axes, trunnion about X", "HSK-A63", generic_source, 30000,
             500, 450, 400, {'A', {-120, 30, 9000, {}}}, 400);
    list.push_back({"linuxcnc-max5",
                    MachineKind::head_table,
                    "LinuxCNC's MAX5, head tilts about Y",
                    "",
                    sample_source,
                    config_zero,
                    {-100, 200, 1200, 100},
                    {-60, 60, 1200, 100},
                    {-149, 1, 1200, 100},
                    {},
                    {},
                    {},
                    {'B', {-90, 90, 2700, 225}},
                    {'C', {-3600, 3600, 2700, 225}}});
    list.push_back({"generic-head-table",
                    MachineKind::head_table,
                    "Five axes, head tilts about Y, table turns about Z",
                    "HSK-A63",
                    generic_source,
                    corner_zero,
                    below_zero(630, 30000),
                    below_zero(560, 30000),
                    below_zero(560, 30000),
                    {},
                    {},
                    {},
                    {'B', {-120, 30, 9000, {}}},
                    {'C', {0, 0, 9000, {}}},
                    630});
    list.push_back({"linuxcnc-bridgemill",
                    MachineKind::head_head,
                    "LinuxCNC's bridge mill, without its axis W",
                    "",
                    sample_source,
                    config_zero,
                    {-500, 500, 12000, 800},
                    {-500, 500, 12000, 800},
                    {-500, 100, 12000, 800},
                    {},
                    {},
                    {},
                    {'B', {-120, 120, 3600, 200}},
                    {'C', {-36000, 36000, 3600, 200}}});
    list.push_back({"generic-head-head",
                    MachineKind::head_head,
                    "Five axes, head turns about Z and tilts about X",
                    "HSK-A63",
                    generic_source,
                    corner_zero,
                    below_zero(2000, 20000),
                    below_zero(1500, 20000),
                    below_zero(800, 20000),
                    {},
                    {},
                    {},
                    {'A', {-110, 110, 6000, {}}},
                    {'C', {-360, 360, 6000, {}}}});
}

} // namespace

std::vector<MachineData> machine_list() {
    std::vector<MachineData> list;
    add_routers(list);
    add_bench_mills(list);
    add_mills(list);
    add_five_axis_machines(list);
    return list;
}

} // namespace app
