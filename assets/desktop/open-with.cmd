@echo off
rem Lists Feeler under "Open with" for NC programs, for this user. "open-with remove" takes it back.
setlocal disabledelayedexpansion
set key=HKCU\Software\Classes
if /i "%~1"=="remove" goto remove
set "exe=%~dp0feeler.exe"
if not exist "%exe%" goto folder
rem In the registry, a percent sign begins an argument. Without one, the path has no second part.
for /f "tokens=2 delims=%%" %%a in ("x%exe%x") do goto folder
reg add "%key%\Feeler.Program" /ve /d "NC program" /f >nul
if errorlevel 1 goto failed
rem With a caret before the outer quotes, the path is between quotes for this shell, too, whatever is in it.
reg add "%key%\Feeler.Program\DefaultIcon" /ve /d ^"\"%exe%\",0^" /f >nul
if errorlevel 1 goto failed
reg add "%key%\Feeler.Program\shell\open\command" /ve /d ^"\"%exe%\" view \"%%1\"^" /f >nul
if errorlevel 1 goto failed
for %%e in (nc ngc tap cnc mpf spf eia min gcode h) do reg add "%key%\.%%e\OpenWithProgids" /v Feeler.Program /t REG_SZ /d "" /f >nul
if errorlevel 1 goto failed
echo Feeler is now listed under "Open with" for NC programs.
exit /b 0

:remove
reg delete "%key%\Feeler.Program" /f >nul 2>nul
for %%e in (nc ngc tap cnc mpf spf eia min gcode h) do reg delete "%key%\.%%e\OpenWithProgids" /v Feeler.Program /f >nul 2>nul
echo Feeler is no longer listed under "Open with".
exit /b 0

:folder
echo feeler.exe must be in the folder of this script, and no folder above it may have %% in its name.
exit /b 1

:failed
echo The registry of this user cannot be written.
exit /b 1
