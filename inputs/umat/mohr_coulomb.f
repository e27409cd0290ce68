C     Elastic, perfectly plastic soil with the yield surface of Mohr
C     and Coulomb, flow by the angle of dilation, and a cut-off of
C     tension at the apex, as a UMAT. It gives the stresses of the
C     model mohr_coulomb. Soil that parts at the apex carries nothing
C     before the gap has closed.
C
C     PROPS   1 Young's modulus [Pa], 2 Poisson's ratio, 3 cohesion
C             [Pa], 4 angle of friction [deg], 5 of dilation [deg]
C     STATEV  1 plastic engineering shear strain, 2 volume strain of
C             the gap
C
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,
     2 STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,CMNAME,
     3 NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     4 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
C
      INCLUDE 'ABA_PARAM.INC'
C
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),
     1 DDSDDE(NTENS,NTENS),DDSDDT(NTENS),DRPLDE(NTENS),
     2 STRAN(NTENS),DSTRAN(NTENS),TIME(2),PREDEF(1),DPRED(1),
     3 PROPS(NPROPS),COORDS(3),DROT(3,3),DFGRD0(3,3),DFGRD1(3,3),
     4 JSTEP(4)
C
      DIMENSION PS(3),AN(3,3),T(3),S(3),BY(3),IORDER(3)
      LOGICAL LOOSE
C
      IF (NPROPS.NE.5 .OR. NSTATV.LT.2 .OR. NDI.NE.3) THEN
        CALL STDB_ABQERR(-3,'mohr_coulomb.f takes 5 properties, '//
     1   '2 states, and plane strain or 3D',0,0.D0,' ')
      END IF
      E=PROPS(1)
      V=PROPS(2)
      G=E/(2.D0*(1.D0+V))
      ALAME=E*V/((1.D0+V)*(1.D0-2.D0*V))
C
C     Stiffness. An explicit program takes the fastest wave from it,
C     so it is the elastic one.
C
      DO J=1,NTENS
        DO I=1,NTENS
          DDSDDE(I,J)=0.D0
        END DO
      END DO
      DO J=1,NDI
        DO I=1,NDI
          DDSDDE(I,J)=ALAME
        END DO
        DDSDDE(J,J)=ALAME+2.D0*G
      END DO
      DO J=NDI+1,NTENS
        DDSDDE(J,J)=G
      END DO
C
C     Elastic trial stress and its principal stresses T(1) largest.
C
      DO J=1,NTENS
        DO I=1,NTENS
          STRESS(I)=STRESS(I)+DDSDDE(I,J)*DSTRAN(J)
        END DO
      END DO
      CALL SPRIND(STRESS,PS,AN,1,NDI,NSHR)
      IORDER(1)=1
      IORDER(2)=2
      IORDER(3)=3
      CALL BIGGER(PS,IORDER(1),IORDER(2))
      CALL BIGGER(PS,IORDER(2),IORDER(3))
      CALL BIGGER(PS,IORDER(1),IORDER(2))
      DO K=1,3
        T(K)=PS(IORDER(K))
      END DO
C
C     A gap closes before the soil takes pressure again. What is left
C     of it takes from the cohesion, and shear opens it no more.
C
      DO K=1,3
        BY(K)=T(K)
      END DO
      LOOSE=.FALSE.
      COHES=PROPS(3)
      IF (PROPS(4).GT.0.D0 .AND. STATEV(2).GT.0.D0) THEN
        CALL CLOSEG(T,V,G,STATEV(2))
        LOOSE=STATEV(2).GT.0.D0
        COHES=COHES*MIN(1.D0,2.D0*EXP(-STATEV(2)))
      END IF
      DO K=1,3
        BY(K)=T(K)-BY(K)
      END DO
      CALL ADDAX(STRESS,BY,AN,IORDER,NSHR)
      CALL RETURNMC(T,V,COHES,PROPS(4),PROPS(5),LOOSE,S,ICUT)
C
C     Stress by the changes along the principal axes, which for
C     NSHR=1 are those of the plane and the axis 3.
C
      BMEAN=0.D0
      DO K=1,3
        BY(K)=S(K)-T(K)
        BMEAN=BMEAN+BY(K)/3.D0
      END DO
      SQUARE=0.D0
      DO K=1,3
        SQUARE=SQUARE+(BY(K)-BMEAN)**2
      END DO
      CALL ADDAX(STRESS,BY,AN,IORDER,NSHR)
      IF (ICUT.EQ.1) STATEV(2)=STATEV(2)+OPENED(BY,V,G,PROPS(5),LOOSE)
      STATEV(1)=STATEV(1)+SQRT(SQUARE/2.D0)/G
      CALL SINV(STRESS,AMEAN,AMISES,NDI,NSHR)
      SSE=AMEAN**2/(2.D0*ALAME+4.D0*G/3.D0)+AMISES**2/(6.D0*G)
      RETURN
      END
C
C     Adds changes BY along the principal axes to a stress.
C
      SUBROUTINE ADDAX(STRESS,BY,AN,IORDER,NSHR)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION STRESS(3+NSHR),BY(3),AN(3,3),IORDER(3)
      DO K=1,3
        I=IORDER(K)
        DO J=1,3
          STRESS(J)=STRESS(J)+BY(K)*AN(I,J)**2
        END DO
        STRESS(4)=STRESS(4)+BY(K)*AN(I,1)*AN(I,2)
        IF (NSHR.EQ.3) THEN
          STRESS(5)=STRESS(5)+BY(K)*AN(I,1)*AN(I,3)
          STRESS(6)=STRESS(6)+BY(K)*AN(I,2)*AN(I,3)
        END IF
      END DO
      RETURN
      END
C
C     Lets a gap (volume strain) close in the directions of principal
C     stresses T that are pressed, by plastic strain in these alone.
C
      SUBROUTINE CLOSEG(T,V,G,GAP)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION T(3),BY(3)
      ASUM=0.D0
      N=0
      DO K=1,3
        BY(K)=MAX(0.D0,-T(K))
        ASUM=ASUM+BY(K)
        IF (T(K).LT.0.D0) N=N+1
      END DO
      IF (N.EQ.0) RETURN
      ACROSS=ASUM*V
      IF (N.EQ.1) ACROSS=ASUM*V/(1.D0-V)
      CLOSES=0.D0
      DO K=1,3
        IF (.NOT.(BY(K).GT.0.D0)) BY(K)=ACROSS
        CLOSES=CLOSES+BY(K)
      END DO
      CLOSES=(1.D0-2.D0*V)/(1.D0+V)*CLOSES/(2.D0*G)
      SHARE=1.D0
      IF (CLOSES.GT.GAP) SHARE=GAP/CLOSES
      DO K=1,3
        T(K)=T(K)+SHARE*BY(K)
      END DO
      IF (CLOSES.GT.GAP) THEN
        GAP=0.D0
      ELSE
        GAP=GAP-CLOSES
      END IF
      RETURN
      END
C
C     Volume strain by which soil parts in a return to the apex that
C     changes principal stresses by BY: that of the plastic strain
C     without the dilatancy of its shear, which loose soil has none of.
C
      FUNCTION OPENED(BY,V,G,PSI,LOOSE)
      INCLUDE 'ABA_PARAM.INC'
      LOGICAL LOOSE
      DIMENSION BY(3)
      DEG=ACOS(-1.D0)/180.D0
      AM=(1.D0+SIN(PSI*DEG))/(1.D0-SIN(PSI*DEG))
      ASUM=BY(1)+BY(2)+BY(3)
      SHEARS=0.D0
      DO K=1,3
        SHEARS=SHEARS+MAX(0.D0,BY(K)-V/(1.D0+V)*ASUM)
      END DO
      DILATE=(AM-1.D0)*SHEARS
      IF (LOOSE) DILATE=0.D0
      OPENED=MAX(0.D0,-(1.D0-2.D0*V)/(1.D0+V)*ASUM-DILATE)/(2.D0*G)
      RETURN
      END
C
C     Puts the places of two values in descending order.
C
      SUBROUTINE BIGGER(PS,I,J)
      INCLUDE 'ABA_PARAM.INC'
      DIMENSION PS(3)
      IF (PS(J).GT.PS(I)) THEN
        K=I
        I=J
        J=K
      END IF
      RETURN
      END
C
C     Return of principal stresses T to S, both in descending order:
C     the plane, its two edges, or the apex (Clausen, Damkilde &
C     Andersen 2006; de Souza Neto, Peric & Owen 2008, 8.2). ICUT is 1
C     where the soil parts. Soil that is loose has shear without
C     dilatancy: its mean stress falls to that of the apex.
C
      SUBROUTINE RETURNMC(T,V,C,PHI,PSI,LOOSE,S,ICUT)
      INCLUDE 'ABA_PARAM.INC'
      LOGICAL LOOSE
      DIMENSION T(3),S(3)
      ICUT=0
      DEG=ACOS(-1.D0)/180.D0
      AK=(1.D0+SIN(PHI*DEG))/(1.D0-SIN(PHI*DEG))
      AM=(1.D0+SIN(PSI*DEG))/(1.D0-SIN(PSI*DEG))
      SC=2.D0*C*COS(PHI*DEG)/(1.D0-SIN(PHI*DEG))
      DO K=1,3
        S(K)=T(K)
      END DO
      F=AK*T(1)-T(3)-SC
      IF (PHI.GT.0.D0) F=MAX(F,T(1)-SC/(AK-1.D0))
      IF (F.LE.0.D0) RETURN
      IF (LOOSE) THEN
        ICUT=1
        AMEAN=(T(1)+T(2)+T(3))/3.D0
        AFTER=MIN(AMEAN,SC/(AK-1.D0))
        AMOST=SC-(AK-1.D0)*AFTER
        WANTED=AK*(T(1)-AMEAN)-(T(3)-AMEAN)
        SHARE=1.D0
        IF (WANTED.GT.0.D0) SHARE=MAX(0.D0,MIN(1.D0,AMOST/WANTED))
        DO K=1,3
          S(K)=AFTER+SHARE*(T(K)-AMEAN)
        END DO
        RETURN
      END IF
      F=AK*T(1)-T(3)-SC
C     The plane.
      H=V*(AM-1.D0)/(1.D0-2.D0*V)
      A=F/(AK*(AM+H)-(H-1.D0))
      S(1)=T(1)-A*(AM+H)
      S(2)=T(2)-A*H
      S(3)=T(3)-A*(H-1.D0)
      IF (S(1).LT.S(2)) THEN
C       The edge S(1) = S(2).
        W=V/(1.D0+V)*(2.D0+AM)
        S(1)=((1.D0-W)*(T(1)+T(2))+(AM-W)*(T(3)+SC))/
     1   (2.D0*(1.D0-W)+(AM-W)*AK)
        S(2)=S(1)
        S(3)=AK*S(1)-SC
      ELSE IF (S(2).LT.S(3)) THEN
C       The edge S(2) = S(3).
        W=V/(1.D0+V)*(1.D0+2.D0*AM)
        S(1)=((1.D0-W)*T(1)+(AM-W)*(T(2)+T(3)+2.D0*SC))/
     1   ((1.D0-W)+2.D0*(AM-W)*AK)
        S(3)=AK*S(1)-SC
        S(2)=S(3)
      END IF
C     The apex, where the edge has left the order of the stresses.
      IF (PHI.GT.0.D0 .AND. S(1).GT.SC/(AK-1.D0)) THEN
        DO K=1,3
          S(K)=SC/(AK-1.D0)
        END DO
        ICUT=1
      END IF
      RETURN
      END
