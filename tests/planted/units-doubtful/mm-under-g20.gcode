; Sign (units: mm)
; the sender wrote G20 before a program made in mm: X60 is 1524
G20
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
