; Sign (units: mm)
; for a sender that writes G21
G21
G90 G94
G17
G54
M3 S12000
G0 Z30
G0 X60 Y40
G1 Z-2 F300
G1 X240 F1200
G0 Z30
M5
M2
