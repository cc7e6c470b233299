%
O1042 (SLOT - The signal may come between the two conditions: then the tool crosses the clamp low)
(T1 D=10. - FLAT END MILL)
G17 G21 G40 G49 G80 G90
G53 G0 Z0.
T1 M6
G54 G90 G0 X-20. Y50. S6000 M3
G43 H1 Z60. M8
G0 Z5.
G1 Z-2. F300.
X50. F600.
G0 Z5.
IF [#1000 EQ 1] GOTO 10
G0 Z60.
N10 G0 X50.
IF [#1000 NE 0] GOTO 20
G0 Y150.
N20 G0 Z60.
M9
M5
G53 G0 Z0.
G53 G0 Y0.
M30
%
