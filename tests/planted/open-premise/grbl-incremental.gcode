(GROOVE - Jogging may have left G91 active: then Z20 goes up by 20, out of travel)
G17 G21 G54 G94
M3 S12000
G0 Z20
X-20 Y50
Z2
G1 Z-2 F300
X120 F800
G0 Z20
M5
M2
