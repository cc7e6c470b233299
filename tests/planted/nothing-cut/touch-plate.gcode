; Groove, made with a hobby CAM
; Z was touched off on a block 40 high, and the 40 were not subtracted
G21
G90 G94
G17
G54
M3 S12000
G0 Z10
G0 X60 Y40
G1 Z-2 F300
G1 X240 F1200
G0 Z10
M5
M2
