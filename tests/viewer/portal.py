#!/usr/bin/python3
"""A file chooser portal for tests: answers each question at once, or as a file tells it to.

Arguments: a file whose lines are the answers, each a path, `cancel` or `wait`; a file to which the
questions are written: method, parent window, title and options. Runs until it is ended.
"""
import sys
import urllib.parse

import dbus
import dbus.mainloop.glib
import dbus.service
from gi.repository import GLib

INTERFACE = "org.freedesktop.portal.FileChooser"
REQUEST = "org.freedesktop.portal.Request"


class Request(dbus.service.Object):
    @dbus.service.signal(REQUEST, signature="ua{sv}")
    def Response(self, code, results):
        pass


class Portal(dbus.service.Object):
    def __init__(self, bus, answers, log):
        super().__init__(bus, "/org/freedesktop/portal/desktop")
        self.bus, self.answers, self.log, self.count = bus, answers, log, 0

    def ask(self, method, parent, title, options):
        with open(self.log, "a", encoding="utf-8") as log:
            folder = bytes(options.get("current_folder", [])).rstrip(b"\0").decode()
            print(method, parent, title, folder, options.get("current_name", ""), sep="|", file=log)
        with open(self.answers, encoding="utf-8") as answers:
            answer = answers.read().splitlines()[self.count]
        self.count += 1
        path = f"/org/freedesktop/portal/desktop/request/test/{self.count}"
        request = Request(self.bus, path)
        chosen = [] if answer == "cancel" else ["file://" + urllib.parse.quote(answer)]
        results = dbus.Dictionary({"uris": dbus.Array(chosen, signature="s")}, signature="sv")
        if answer != "wait":
            GLib.timeout_add(200, lambda: request.Response(dbus.UInt32(not chosen), results))
        return dbus.ObjectPath(path)

    @dbus.service.method(INTERFACE, in_signature="ssa{sv}", out_signature="o")
    def OpenFile(self, parent, title, options):
        return self.ask("OpenFile", parent, title, options)

    @dbus.service.method(INTERFACE, in_signature="ssa{sv}", out_signature="o")
    def SaveFile(self, parent, title, options):
        return self.ask("SaveFile", parent, title, options)


def main():
    dbus.mainloop.glib.DBusGMainLoop(set_as_default=True)
    bus = dbus.SessionBus()
    name = dbus.service.BusName("org.freedesktop.portal.Desktop", bus)
    portal = Portal(bus, sys.argv[1], sys.argv[2])
    print("ready", name.get_name(), portal.count, flush=True)
    GLib.MainLoop().run()


main()
