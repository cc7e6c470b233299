#pragma once

namespace app_test {

/// Programs that leave open what an operator knows, or start from where the axes are.
inline constexpr const char* bare_programs[] = {
    "%\nO1\n(T3 D=6. CR=0. - ZMIN=-5. - FLAT END MILL)\nG21 G90 G17 G54\nT3 M6\nS5000 M3\nG0 G43 "
    "H3 Z20.\nX10. Y10.\nZ2.\nG1 Z-5. F200\nX40. F600\nY30.\nG0 Z20.\nT4 M6\nS900 M3\nG43 H4 "
    "Z20.\nG81 X20. Y20. Z-4. R2. F90\nG80\nG28 G91 Z0.\nM30\n%\n",
    "G21 G90\nM3\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nX20\nG0 Z5\nT1 M6\nG43 H1 Z3\nG1 X5\nG0 Z9\nM2\n",
    "G20 G90 G55\n(60 deg v-bit 1/4\")\nT2 M6\nM3 S1000\nG43 H2 Z1\nG0 X0 Y0\nG1 Z-.1 F5\nX1\n"
    "G0 Z1\nM2\n",
    "G21 G91\nG0 X5 Y5\nG1 Z-501 F100\nX30\nG0 Z501\nM2\n",
    "G21 G90\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F100\nX20\nG0 Z5\nX3\nM2\n",
    "G21 G90 G54\nT1 M6\nS1000 M3\nG43 H1 Z50\nG0 X0 Y0\nZ5\nG1 Z-2 F200\nX50\nG0 Z50\nG55\nX0 Y0\n"
    "Z5\nG1 Z-2\nX60\nG0 Z50\nG53 G0 Z0\nM30\n",
    "G21 G90\nT1 M6\nS1000 M3\nG0 Z50\nX0 Y0\nZ5\nG1 Z-2 F200\nX50\nG0 Z50\nA90\nX0\nG1 Z-2\nX50\n"
    "G0 Z50\nA0\nM2\n",
    "G21 G90\nM3 S1000\nG0 Z2\nG0 X0 Y0\nG1 Z-1 F100\nX4\nY3\nX0\nG0 Z2\nM2\n"};

} // namespace app_test
