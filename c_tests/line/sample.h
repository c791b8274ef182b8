/* The sample communication of the page "Ozeki Line Protocol", line by line: what the PC sends begins with '>'. */
#ifndef LINE_SAMPLE_H
#define LINE_SAMPLE_H

#define MOTOR(axis)                                                                                                    \
    "c=motordetails&axis=" axis "&velocity=9600.00&stepangle=1.80&stepanglediv=16&acceleration=131072&id=6O1KiA&t=0"
#define HEATER(temp, t) "c=heaterinfo&temp=" temp "&desiredtemp=-1000.00&state=0&id=M1F910&t=" t

static const char *const SAMPLE[] = {
    "c=welcome&id=0uAAly&type=OzekiIDManager&pos=1&version=1.0.0",
    "c=welcome&id=6O1KiA&type=OzekiStepperMotorMultiController&pos=2&version=1.0.0",
    "c=welcome&id=3Mx14T&type=OzekiButtonController&pos=3&name=StopYmin&version=1.0.0",
    "c=welcome&id=xvnuu3&type=OzekiButtonController&pos=4&name=StopYmax&version=1.0.0",
    "c=welcome&id=1988L4&type=OzekiButtonController&pos=5&name=StopZmin&version=1.0.0",
    "c=welcome&id=M1F910&type=OzekiTemperatureController&pos=6&name=HeaterExt1&version=1.0.0",
    "c=welcome&id=9o5qzg&type=OzekiSwitchController&pos=7&name=FanExt1&version=1.0.0",
    "c=motorsnumber&count=4&id=6O1KiA&t=0",
    MOTOR("x"),
    MOTOR("y"),
    MOTOR("z"),
    MOTOR("a"),
    "c=welcome&type=Ozeki3DPrinterDisc&id=OZPDSC&version=1.0.0",
    ">c=setpushinfo&interval=2000&state=1&t=0&id=M1F910",
    "c=setpushinfo_resp&state=1&interval=2000&id=M1F910&t=1",
    HEATER("110.44", "2"),
    HEATER("121.01", "3"),
    HEATER("125.93", "4"),
    HEATER("128.28", "5"),
    HEATER("129.48", "6"),
    HEATER("129.87", "7"),
    HEATER("130.47", "8"),
    HEATER("131.15", "9"),
    HEATER("131.15", "10"),
    ">c=setswitch&state=1&t=11&id=9o5qzg",
    "c=setswitch_resp&state=1&pwm=254&id=9o5qzg&t=12",
    HEATER("131.71", "13"),
    ">c=setswitch&state=0&t=14&id=9o5qzg",
    "c=setswitch_resp&state=0&pwm=254&id=9o5qzg&t=15",
    HEATER("131.65", "16"),
    HEATER("132.22", "17"),
};
enum { SAMPLE_LINES = sizeof SAMPLE / sizeof *SAMPLE };

#endif
