; Sign.svg
; 1 tool path was skipped: no tool is selected
G21
G90
M5
M2
