// Who keeps what a student has done: this browser, where it lets a file keep anything; in a course, its system (course.js).

const keptAs = () => `mpm-lab ${DATA.lesson.name}`;
let keeper = {
  name: "",  // of the student, where it is known
  hint: tr("It gives you your own numbers, and the file that you hand in contains it. It is not sent to anybody."),
  handed: tr("Hand in saves a file with your answers and times, and your name if you have given one. Nothing is sent to anybody."),
  forget: tr("Forget all answers in this browser?"),
  read: () => JSON.parse(localStorage.getItem(keptAs())),
  write(progress) {
    try {
      localStorage.setItem(keptAs(), JSON.stringify(progress));
    } catch {
      // this browser keeps nothing for files: then it lasts as long as the page is open
    }
  },
  answered: () => {},  // it keeps what is written, which has all answers
};
