@echo off
rem Lists Feeler under "Open with" for NC programs, for this user. "open-with remove" takes it back.
setlocal
set key=HKCU\Software\Classes
set "exe=%~dp0feeler.exe"
rem For folders with & and the like in their names.
setlocal enabledelayedexpansion
if /i "%~1"=="remove" goto remove
reg add "%key%\Feeler.Program" /ve /d "NC program" /f >nul
if errorlevel 1 goto failed
reg add "%key%\Feeler.Program\DefaultIcon" /ve /d "\"!exe!\",0" /f >nul
if errorlevel 1 goto failed
reg add "%key%\Feeler.Program\shell\open\command" /ve /d "\"!exe!\" view \"%%1\"" /f >nul
if errorlevel 1 goto failed
for %%e in (nc ngc tap mpf spf eia min gcode h) do reg add "%key%\.%%e\OpenWithProgids" /v Feeler.Program /t REG_SZ /d "" /f >nul
if errorlevel 1 goto failed
echo Feeler is now listed under "Open with" for NC programs.
exit /b 0

:remove
reg delete "%key%\Feeler.Program" /f >nul 2>nul
for %%e in (nc ngc tap mpf spf eia min gcode h) do reg delete "%key%\.%%e\OpenWithProgids" /v Feeler.Program /f >nul 2>nul
echo Feeler is no longer listed under "Open with".
exit /b 0

:failed
echo The registry of this user cannot be written.
exit /b 1
